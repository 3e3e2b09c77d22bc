#include "bench/report/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gigabake::bench {
namespace {

constexpr double width = 720, height = 440, left = 70, right = 190, top = 40, bottom = 55;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

std::string text(double x, double y, const char* attributes, const std::string& content) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, attributes, escaped(content));
}

/// An axis from 0 to a little beyond the maximum, in steps of 1, 2 or 5 times a power of ten.
struct Axis {
  double end = 1, step = 1;

  explicit Axis(double greatest) {
    if (!(greatest > 0)) return;
    step = std::pow(10, std::floor(std::log10(greatest / 4)));
    for (const double factor : {2.0, 2.5, 2.0})
      if (greatest / step > 8) step *= factor;
    end = std::ceil(greatest * 1.02 / step) * step;
  }
  int steps() const { return int(std::lround(end / step)); }
};

class Canvas {
 public:
  explicit Canvas(const Plot& plot) : x_(greatest(plot, &PlotPoint::x)), y_(greatest(plot, &PlotPoint::y)) {
    out_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width, height);
  }

  double at_x(double v) const { return left + v / x_.end * (width - left - right); }
  double at_y(double v) const { return height - bottom - v / y_.end * (height - top - bottom); }

  void draw_axes(const Plot& plot) {
    for (int i = 0; i <= x_.steps(); ++i) {
      const double v = i * x_.step;
      line(at_x(v), at_y(0), at_x(v), at_y(y_.end), "#ddd");
      out_ += text(at_x(v), at_y(0) + 18, "text-anchor=\"middle\"", fmt::format("{:g}", v));
    }
    for (int i = 0; i <= y_.steps(); ++i) {
      const double v = i * y_.step;
      line(at_x(0), at_y(v), at_x(x_.end), at_y(v), "#ddd");
      out_ += text(at_x(0) - 8, at_y(v) + 4, "text-anchor=\"end\"", fmt::format("{:g}", v));
    }
    out_ += text(left, top - 16, "font-size=\"15\"", plot.title);
    out_ += text((left + width - right) / 2, height - 14, "text-anchor=\"middle\"", plot.x_axis);
    out_ += text(0, 0, "text-anchor=\"middle\" transform=\"translate(18 210) rotate(-90)\"", plot.y_axis);
  }

  void join(const std::vector<PlotPoint>& points) {
    out_ += "<polyline fill=\"none\" stroke=\"#999\" points=\"";
    for (const PlotPoint& p : points) out_ += fmt::format("{:.1f},{:.1f} ", at_x(p.x), at_y(p.y));
    out_ += "\"/>\n";
    for (const PlotPoint& p : points) out_ += text(at_x(p.x) + 7, at_y(p.y) - 6, "font-size=\"10\"", p.name);
  }

  /// Draws a series. The title of a point is visible while the mouse is over it.
  void draw_series(const PlotSeries& series, std::size_t row) {
    const auto dot = [&](double x, double y, const std::string& name) {
      out_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"{}\"><title>{}</title></circle>\n", x, y,
                          series.colour, escaped(name));
    };
    for (const PlotPoint& p : series.points)
      dot(at_x(p.x), at_y(p.y), fmt::format("{}: {:.4g}, {:.4g}", p.name, p.x, p.y));
    const double y = top + 10 + 20 * double(row);
    dot(width - right + 20, y, series.name);
    out_ += text(width - right + 32, y + 4, "", series.name);
  }

  std::string finish() { return out_ + "</svg>\n"; }

 private:
  static double greatest(const Plot& plot, double PlotPoint::*value) {
    double maximum = 0;
    for (const PlotSeries& series : plot.series)
      for (const PlotPoint& p : series.points) maximum = std::max(maximum, p.*value);
    return maximum;
  }

  void line(double x1, double y1, double x2, double y2, const char* colour) {
    out_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2,
                        y2, colour);
  }

  Axis x_, y_;
  std::string out_;
};

}  // namespace

std::vector<PlotPoint> best_of(const Plot& plot) {
  std::vector<PlotPoint> all;
  for (const PlotSeries& series : plot.series) all.insert(all.end(), series.points.begin(), series.points.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const PlotPoint& a, const PlotPoint& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<PlotPoint> best;
  for (const PlotPoint& p : all)
    if (best.empty() || p.y < best.back().y) best.push_back(p);
  return best;
}

std::string to_svg(const Plot& plot) {
  Canvas canvas(plot);
  canvas.draw_axes(plot);
  canvas.join(best_of(plot));
  for (std::size_t i = 0; i < plot.series.size(); ++i) canvas.draw_series(plot.series[i], i);
  return canvas.finish();
}

}  // namespace gigabake::bench
