/// A socket client for tests that sends any bytes, also invalid requests.
#pragma once

#include <string>

namespace gigabake {

class HttpClient {
 public:
  explicit HttpClient(int port);
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  /// Sends the bytes. Returns false if the server has closed.
  bool send(const std::string& bytes);
  /// Receives until the server closes, `maximum` bytes have arrived or the server has been silent for `idle_timeout_s`.
  std::string receive(std::size_t maximum, double idle_timeout_s = 2);
  /// Receives until `ending` arrives or the server is silent for half a minute.
  std::string receive_until(const std::string& ending);
  /// Receives the head and the body of one answer that states its Content-Length. Returns the received part if the
  /// answer stays incomplete.
  std::string answer();

 private:
  int socket_ = -1;
};

/// Sends one request on a separate connection and returns the answer. `head` contains further header lines, each of
/// which ends with CR LF.
std::string ask(int port, const std::string& method, const std::string& target, const std::string& head = "",
                const std::string& body = "");
/// Returns the status of an answer; 0 if it has none.
int status_of(const std::string& answer);
std::string body_of(const std::string& answer);

}  // namespace gigabake
