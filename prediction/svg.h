// A drawing in SVG: just the shapes that our plans and plots are made of.
//
// Sizes are pixels of the drawing, x to the right and y down, as SVG has it. Numbers are written
// with two decimals at most, text is escaped, so the result is well-formed whatever goes in; a
// coordinate that is not finite is written as 0.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>

namespace forewalk::prediction {

/// A number as SVG wants it: at most two decimals, none that say nothing ("3", "0.5", "-12.25").
std::string svgNumber(double value);

/// Text with &, <, > and quotes escaped, and control characters (which XML forbids) left out.
std::string escapeXml(std::string_view text);

/// Where text stands relative to its point.
enum class Anchor { kStart, kMiddle, kEnd };

/// Grows as shapes are added, the later ones on top. `style` is written into the element as it
/// stands, so it must be attributes of ours (`fill="#fff" stroke="none"`), never text from outside.
class SvgDrawing {
 public:
  /// A canvas of width x height pixels, > 0, filled with `background` (a colour).
  SvgDrawing(double width, double height, std::string_view background);

  void circle(glm::dvec2 centre, double radius, std::string_view style);
  void rectangle(glm::dvec2 corner, glm::dvec2 size, std::string_view style);
  void line(glm::dvec2 from, glm::dvec2 to, std::string_view style);
  /// Open, or closed to a polygon. Nothing for fewer than two points.
  void polyline(std::span<const glm::dvec2> points, bool closed, std::string_view style);
  /// An element with path data made by moveTo and lineTo below; nothing where `data` is empty.
  void path(std::string_view data, std::string_view style);
  void text(glm::dvec2 at, std::string_view words, double size, Anchor anchor,
            std::string_view style = "fill=\"#2b3440\"");
  /// Everything until endGroup() shares `style`.
  void beginGroup(std::string_view style);
  void endGroup();
  /// Everything until endGroup() is cut off at the rectangle.
  void beginClip(glm::dvec2 corner, glm::dvec2 size);
  /// These three change the group at hand over and over (SMIL), each round `seconds` long and begun
  /// when the drawing is shown. `values` are separated by ";" and spread evenly over the round,
  /// linear in between; the last one is met at its end. `kind` is that of a transform.
  void animate(std::string_view attribute, std::string_view values, double seconds);
  void animateTransform(std::string_view kind, std::string_view values, double seconds);
  /// Visible from share `from` of the round to `to`, 0 <= from < to <= 1, else not.
  void showDuring(double from, double to, double seconds);
  /// A tooltip and accessible name for the whole drawing; call it first.
  void title(std::string_view words);

  /// The finished document, XML 1.0, UTF-8.
  std::string finish() const;

 private:
  std::string head_;
  std::string body_;
  int clips_ = 0;
};

/// Appends to path data.
void moveTo(std::string& data, glm::dvec2 point);
void lineTo(std::string& data, glm::dvec2 point);

/// About how wide `words` is at font size 1, for placing labels; a sans-serif is assumed.
double textWidth(std::string_view words);

}  // namespace forewalk::prediction
