#include "picture/picture.hpp"

#include <cairo-svg.h>
#include <cairo.h>

#include <cstddef>
#include <map>
#include <regex>
#include <string_view>

#include "formats/ascii.hpp"
#include "formats/atomic_file.hpp"
#include "formats/bad_input.hpp"
#include "picture/page.hpp"

namespace curbline::tools {
namespace {

using namespace picture;

bool is_png(const std::string& path) {
  return lower_case(path).ends_with(".png");
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void check(cairo_status_t status, const std::string& path) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw BadInput(path + ": cannot be drawn: " + cairo_status_to_string(status) + "; expected memory and room for it");
}

std::string escaped(std::string_view words) {
  std::string result;
  for (const char c : words) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return result;
}

/// Cairo numbers its ids throughout the life of the program; numbered within the file, the same map always gives the
/// same bytes.
std::string renumbered(const std::string& svg) {
  static const std::regex name(R"re((id="|href="#|url\(#)([a-z-]+)([0-9]+)(?=["\)]))re");
  std::map<std::string, std::size_t> numbers;
  std::string result;
  std::size_t done = 0;
  for (std::sregex_iterator match(svg.begin(), svg.end(), name); match != std::sregex_iterator(); ++match) {
    const auto number = numbers.try_emplace(match->str(2) + match->str(3), numbers.size()).first->second;
    result.append(svg, done, static_cast<std::size_t>(match->position(3)) - done);
    result += std::to_string(number);
    done = static_cast<std::size_t>(match->position() + match->length());
  }
  return result.append(svg, done);
}

/// Cairo draws texts as outlines; this adds text that can be read and searched.
void describe(std::string& svg, const std::string& title, const std::vector<std::string>& curb_texts) {
  std::string words = "\n<title>" + escaped(printable(title)) + "</title>\n<desc>";
  for (const std::string& text : curb_texts) words += (&text == &curb_texts.front() ? "curbs: " : ", ") + text;
  svg.insert(svg.find('>', svg.find("<svg")) + 1, words + "</desc>");
}

std::string png(const Map& map, const PictureExtras& extras, const std::string& path) {
  const Page page = lay_out(map, extras);
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(page.width), static_cast<int>(page.height)));
  const Context cr(cairo_create(surface.get()));
  draw(cr.get(), page, map, extras);
  check(cairo_status(cr.get()), path);
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &bytes), path);
  return bytes;
}

std::string svg(const Map& map, const PictureExtras& extras, const std::string& path) {
  const Page page = lay_out(map, extras);
  std::string bytes;
  const Surface surface(cairo_svg_surface_create_for_stream(append, &bytes, page.width, page.height));
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  const Context cr(cairo_create(surface.get()));
  const std::vector<std::string> curb_texts = draw(cr.get(), page, map, extras);
  check(cairo_status(cr.get()), path);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()), path);
  std::string result = renumbered(bytes);
  describe(result, extras.title, curb_texts);
  return result;
}

}  // namespace

void check_picture_name(const std::string& path) {
  if (!is_png(path) && !lower_case(path).ends_with(".svg"))
    throw BadInput(path + ": cannot tell the kind of picture; expected a name that ends in .png or .svg");
}

void draw_picture(const Map& map, AtomicFile& file, const PictureExtras& extras) {
  check_picture_name(file.path());
  file.stream() << (is_png(file.path()) ? png(map, extras, file.path()) : svg(map, extras, file.path()));
}

void draw_picture(const Map& map, const std::string& path, const PictureExtras& extras) {
  check_picture_name(path);
  AtomicFile file(path);
  draw_picture(map, file, extras);
  file.commit();
}

}  // namespace curbline::tools
