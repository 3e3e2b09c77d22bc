#include "http_client.h"

#include <arpa/inet.h>
#include <cmath>
#include <cstdint>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gigabake {

HttpClient::HttpClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(std::uint16_t(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket_);
    socket_ = -1;
  }
}

HttpClient::~HttpClient() {
  if (socket_ >= 0) ::close(socket_);
}

bool HttpClient::send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t n = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return false;
    sent += std::size_t(n);
  }
  return true;
}

std::string HttpClient::receive(std::size_t maximum, double idle_timeout_s) {
  std::string out;
  char buffer[16384];
  while (out.size() < maximum) {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, int(std::lround(idle_timeout_s * 1000))) <= 0) break;
    const ssize_t n = ::recv(socket_, buffer, std::min(sizeof buffer, maximum - out.size()), 0);
    if (n <= 0) break;
    out.append(buffer, std::size_t(n));
  }
  return out;
}

std::string HttpClient::receive_until(const std::string& ending) {
  std::string out;
  while (!out.ends_with(ending)) {
    const std::string more = receive(1, 30);
    if (more.empty()) break;
    out += more;
  }
  return out;
}

std::string HttpClient::answer() {
  const std::string out = receive_until("\r\n\r\n");
  const std::size_t at = out.find("Content-Length: ");
  return at == std::string::npos ? out : out + receive(std::stoul(out.substr(at + 16)), 30);
}

std::string ask(int port, const std::string& method, const std::string& target, const std::string& head,
                const std::string& body) {
  std::string request = method + " " + target + " HTTP/1.1\r\nConnection: close\r\n" + head;
  if (head.find("Host:") == std::string::npos) request += "Host: localhost\r\n";
  if (method == "POST" && head.find("Content-Length:") == std::string::npos)
    request += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  if (method == "POST" && head.find("Content-Type:") == std::string::npos)
    request += "Content-Type: application/json\r\n";
  HttpClient client(port);
  client.send(request + "\r\n" + body);
  return client.answer();
}

int status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
}

std::string body_of(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

}  // namespace gigabake
