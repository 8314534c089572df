#include "apps/report/sections/published.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/numbers.hpp"

namespace calomel {

namespace {

struct Published {
  const char* method;
  double density;         ///< [kg/m3]
  double sound_speed;     ///< [m/s]
  double tensile_cutoff;  ///< [Pa]
};
constexpr std::array<Published, 2> answers{{{"ENC", 10345, 2020, 85642}, {"SPE", 7720, 2449, 53300}}};

constexpr double mercury = 13546;  ///< density at 20 degrees Celsius [kg/m3]
constexpr double near = 0.05;      ///< relative change of the density that temperature and gas may cause

/// The names of the case's parameters, by their keys.
std::map<std::string, std::string> names_by_key(const ReportInput& input) {
  std::map<std::string, std::string> names;
  for (const auto& p : input.parameters) names[p.key.empty() ? "material.mercury." + p.name : p.key] = p.name;
  return names;
}

Html with_sign(double x) { return fragment(x > 0 ? "+" : "", fixed_html(x, std::abs(x) < 9.95 ? 1 : 0)); }

}  // namespace

std::vector<PublishedAnswer> published_answers(const ReportInput& input) {
  const auto names = names_by_key(input);
  const std::array<std::string, 3> keys{"material.mercury.density", "material.mercury.sound_speed", "material.mercury.tensile_cutoff"};
  if (names.size() != keys.size() || std::any_of(keys.begin(), keys.end(), [&](const auto& k) { return !names.contains(k); })) return {};
  const auto own = impedance(input).density_value;
  if (!own || std::abs(*own / mercury - 1) > near) return {};
  std::vector<PublishedAnswer> out;
  for (const auto& a : answers)
    out.push_back(
        {std::string(a.method) + ", published", {{names.at(keys[0]), a.density}, {names.at(keys[1]), a.sound_speed}, {names.at(keys[2]), a.tensile_cutoff}}});
  return out;
}

namespace {

struct Moments {
  double mean = 0;
  double sd = 0;
};

Moments moments_of(const std::vector<double>& values) {
  const double n = double(values.size());
  double mean = 0;
  double square = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) square += (v - mean) * (v - mean) / n;
  return {mean, std::sqrt(square)};
}

/// "name +2.1": the distances of an optimum from the mean of the posterior, in its standard deviations.
Html distances(const Json& theta, const std::map<std::string, Moments>& posterior, const ReportInput& input) {
  std::vector<Html> list;
  for (const auto& p : input.parameters) {
    const auto at = posterior.find(p.name);
    const auto value = number_at(theta, p.name);
    if (at == posterior.end() || !value || !(at->second.sd > 0)) continue;
    list.push_back(fragment(p.name, " ", with_sign((*value - at->second.mean) / at->second.sd)));
  }
  return joined(list, ", ");
}

}  // namespace

Html published_paragraph(const Study& study, const ReportInput& input) {
  const auto list = published_answers(input);
  if (list.empty() || !study.posterior) return {};
  const Draws& draws = *study.posterior;
  const Impedance z = impedance(input);
  std::map<std::string, Moments> posterior;
  std::map<std::string, std::vector<double>> values;
  for (std::size_t k = 0; k < draws.names.size(); ++k) {
    values[draws.names[k]] = draws.of(k);
    posterior[draws.names[k]] = moments_of(values[draws.names[k]]);
  }
  if (!posterior.contains(z.density) || !posterior.contains(z.sound_speed)) return {};
  double product = 0;
  const double n = double(draws.chains * draws.draws);
  for (std::size_t i = 0; i < values[z.density].size(); ++i) product += values[z.density][i] * values[z.sound_speed][i] / n;
  const std::string cutoff = names_by_key(input).at("material.mercury.tensile_cutoff");
  Html items;
  for (const auto& answer : list) {
    const Json& theta = answer.theta;
    items += list_item(fragment(answer.label.substr(0, answer.label.find(',')), " ", number_html(*number_at(theta, z.density), 5), "\u00a0kg/m\u00b3, ",
                                number_html(*number_at(theta, z.sound_speed), 4), "\u00a0m/s, ", number_html(*number_at(theta, cutoff), 5),
                                "\u00a0Pa: \u03c1c = ", fixed_html(*z.at(theta) * 1e-6, 1),
                                "\u00a0MPa\u00b7s/m; from the mean of this posterior, in its standard deviations: ", distances(theta, posterior, input)));
  }
  return paragraph(
             "Published for mercury are (M. I. Radaideh, H. Tran, L. Lin, H. Jiang, D. Winder, S. Gorti, G. Zhang, J. Mach, S. Cousineau, \u201cModel "
             "Calibration of "
             "the Liquid Mercury Spallation Target using Evolutionary Neural Networks and Sparse Polynomial Expansions\u201d, 2022, arXiv:2202.09353):") +
         element("ul", "\n", items) + "\n" +
         paragraph("Here \u03c1c is ", fixed_html(product * 1e-6, 1),
                   "\u00a0MPa\u00b7s/m. They fit that paper\u2019s records and target, so they need not lie here. Mercury\u2019s density is near "
                   "13\u202f500\u00a0kg/m\u00b3: the authors find their values far from the nominal properties, and give the form of the model and errors of "
                   "the measurements "
                   "as reasons. Density and sound speed trade against each other along \u03c1c = const, the dashed line of the corner plot.");
}

}  // namespace calomel
