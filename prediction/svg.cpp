#include "prediction/svg.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace forewalk::prediction {

std::string svgNumber(double value) {
  if (!std::isfinite(value)) return "0";
  std::string text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string escapeXml(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&apos;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n') escaped += c;
    }
  }
  return escaped;
}

SvgDrawing::SvgDrawing(double width, double height, std::string_view background)
    : head_(fmt::format(
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
          "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" "
          "stroke-linecap=\"round\" stroke-linejoin=\"round\">\n",
          svgNumber(width), svgNumber(height))) {
  rectangle({0, 0}, {width, height}, fmt::format("fill=\"{}\"", background));
}

void SvgDrawing::circle(glm::dvec2 centre, double radius, std::string_view style) {
  fmt::format_to(std::back_inserter(body_), "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {}/>\n",
                 svgNumber(centre.x), svgNumber(centre.y), svgNumber(radius), style);
}

void SvgDrawing::rectangle(glm::dvec2 corner, glm::dvec2 size, std::string_view style) {
  fmt::format_to(std::back_inserter(body_),
                 "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {}/>\n", svgNumber(corner.x),
                 svgNumber(corner.y), svgNumber(size.x), svgNumber(size.y), style);
}

void SvgDrawing::line(glm::dvec2 from, glm::dvec2 to, std::string_view style) {
  fmt::format_to(std::back_inserter(body_), "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n",
                 svgNumber(from.x), svgNumber(from.y), svgNumber(to.x), svgNumber(to.y), style);
}

void SvgDrawing::polyline(std::span<const glm::dvec2> points, bool closed, std::string_view style) {
  if (points.size() < 2) return;
  std::string data;
  moveTo(data, points.front());
  for (const glm::dvec2 point : points.subspan(1)) lineTo(data, point);
  if (closed) data += 'Z';
  path(data, style);
}

void SvgDrawing::path(std::string_view data, std::string_view style) {
  if (data.empty()) return;
  fmt::format_to(std::back_inserter(body_), "<path d=\"{}\" {}/>\n", data, style);
}

void SvgDrawing::text(glm::dvec2 at, std::string_view words, double size, Anchor anchor,
                      std::string_view style) {
  constexpr std::string_view kAnchors[] = {"start", "middle", "end"};
  fmt::format_to(std::back_inserter(body_),
                 "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" {}>{}</text>\n",
                 svgNumber(at.x), svgNumber(at.y), svgNumber(size),
                 kAnchors[static_cast<int>(anchor)], style, escapeXml(words));
}

void SvgDrawing::beginGroup(std::string_view style) {
  fmt::format_to(std::back_inserter(body_), "<g {}>\n", style);
}

void SvgDrawing::endGroup() { body_ += "</g>\n"; }

void SvgDrawing::beginClip(glm::dvec2 corner, glm::dvec2 size) {
  fmt::format_to(std::back_inserter(body_),
                 "<clipPath id=\"clip{0}\"><rect x=\"{1}\" y=\"{2}\" width=\"{3}\" "
                 "height=\"{4}\"/></clipPath>\n<g clip-path=\"url(#clip{0})\">\n",
                 clips_++, svgNumber(corner.x), svgNumber(corner.y), svgNumber(size.x),
                 svgNumber(size.y));
}

void SvgDrawing::animate(std::string_view attribute, std::string_view values, double seconds) {
  fmt::format_to(std::back_inserter(body_),
                 "<animate attributeName=\"{}\" values=\"{}\" dur=\"{}s\" "
                 "repeatCount=\"indefinite\"/>\n",
                 attribute, values, svgNumber(seconds));
}

void SvgDrawing::animateTransform(std::string_view kind, std::string_view values, double seconds) {
  fmt::format_to(std::back_inserter(body_),
                 "<animateTransform attributeName=\"transform\" type=\"{}\" values=\"{}\" "
                 "dur=\"{}s\" repeatCount=\"indefinite\"/>\n",
                 kind, values, svgNumber(seconds));
}

void SvgDrawing::showDuring(double from, double to, double seconds) {
  const bool first = from <= 0.0, last = to >= 1.0;
  fmt::format_to(std::back_inserter(body_),
                 "<animate attributeName=\"visibility\" calcMode=\"discrete\" "
                 "values=\"{}visible{}\" keyTimes=\"0{}{}\" dur=\"{}s\" "
                 "repeatCount=\"indefinite\"/>\n",
                 first ? "" : "hidden;", last ? "" : ";hidden",
                 first ? "" : fmt::format(";{:.5f}", from), last ? "" : fmt::format(";{:.5f}", to),
                 svgNumber(seconds));
}

void SvgDrawing::title(std::string_view words) {
  head_ += fmt::format("<title>{}</title>\n", escapeXml(words));
}

std::string SvgDrawing::finish() const { return head_ + body_ + "</svg>\n"; }

void moveTo(std::string& data, glm::dvec2 point) {
  data += fmt::format("M{} {}", svgNumber(point.x), svgNumber(point.y));
}

void lineTo(std::string& data, glm::dvec2 point) {
  data += fmt::format("L{} {}", svgNumber(point.x), svgNumber(point.y));
}

double textWidth(std::string_view words) { return 0.54 * static_cast<double>(words.size()); }

}  // namespace forewalk::prediction
