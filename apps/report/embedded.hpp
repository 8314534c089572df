#pragma once
/// The files of the report page at build time. embed.cmake writes the definitions.
#include <string_view>

namespace calomel::embedded {

extern const std::string_view page_html, page_css, drawing_js, histories_js, target_js, diagnosis_js, chains_js, corner_js, sensitivity_js, page_js;
/// Dygraphs 2 (MIT) and three.js r111 (MIT), as Debian ships them.
extern const std::string_view dygraphs_js, dygraphs_css, synchronizer_js, three_js, orbit_controls_js;

}  // namespace calomel::embedded
