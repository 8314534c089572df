#include "uq/posterior_file.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>

#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

namespace {

constexpr std::array<std::string_view, 8> known_groups{"posterior", "unconstrained_posterior", "sample_stats", "log_likelihood", "posterior_predictive",
                                                       "prior",     "prior_predictive",        "observed_data"};

/// The first dimensions of a group's variables.
std::vector<std::string> own_dimensions(const PosteriorGroup& group) {
  return group.chains > 0 ? std::vector<std::string>{"chain", "draw"} : std::vector<std::string>();
}

Attributes with_unit(const std::string& unit) { return unit.empty() ? Attributes() : Attributes{{"units", unit}}; }

void write_group(NetcdfWriter& file, const PosteriorGroup& group) {
  expect(std::find(known_groups.begin(), known_groups.end(), group.name) != known_groups.end(), "a group of posterior.nc is one of ArviZ's");
  file.group(group.name);
  file.attribute("inference_library", "calomel");
  file.attribute("inference_library_version", version);
  if (group.chains > 0)
    for (const auto& [name, size] : {std::pair{"chain", group.chains}, std::pair{"draw", group.draws}}) {
      std::vector<int> numbers(size);
      std::iota(numbers.begin(), numbers.end(), 0);
      if (std::string_view(name) == "draw" && !group.draw_numbers.empty()) numbers = group.draw_numbers;
      file.dimension(name, size);
      file.variable(name, {name}, numbers);
    }
  for (const auto& c : group.coordinates) {
    file.dimension(c.name, std::max(c.numbers.size(), c.words.size()));
    if (c.words.empty())
      file.variable(c.name, {c.name}, c.numbers, with_unit(c.unit));
    else
      file.variable(c.name, {c.name}, c.words, with_unit(c.unit));
  }
  for (const auto& v : group.variables) {
    auto dims = own_dimensions(group);
    dims.insert(dims.end(), v.dims.begin(), v.dims.end());
    if (v.kind == PosteriorVariable::Kind::real)
      file.variable(v.name, dims, v.values, with_unit(v.unit));
    else if (v.kind == PosteriorVariable::Kind::whole)
      file.variable(v.name, dims, std::vector<int>(v.values.begin(), v.values.end()), with_unit(v.unit));
    else
      file.variable(v.name, dims, std::vector<std::int8_t>(v.values.begin(), v.values.end()), {{"dtype", "bool"}});
  }
}

PosteriorGroup read_group(const NetcdfReader& file, const std::string& name) {
  PosteriorGroup group{.name = name};
  for (const auto& variable : file.variables(name)) {
    const std::string full = name + '/' + variable;
    const auto dims = file.dimensions(full);
    if (variable == "chain" || variable == "draw") {
      (variable == "chain" ? group.chains : group.draws) = file.shape(full).at(0);
    } else if (dims == std::vector{variable}) {
      PosteriorCoordinate c{.name = variable, .unit = file.attribute("units", full)};
      if (file.holds_text(full))
        c.words = file.strings(full);
      else
        c.numbers = file.doubles(full);
      group.coordinates.push_back(std::move(c));
    } else {
      const std::size_t own = dims.size() >= 2 && dims[0] == "chain" && dims[1] == "draw" ? 2 : 0;
      if (own == 0 && name != "observed_data") continue;  // the variable does not belong to this schema
      group.variables.push_back(
          {.name = variable, .unit = file.attribute("units", full), .dims = {dims.begin() + std::ptrdiff_t(own), dims.end()}, .values = file.doubles(full)});
    }
  }
  return group;
}

}  // namespace

const PosteriorVariable* PosteriorGroup::variable(const std::string& wanted) const {
  for (const auto& v : variables)
    if (v.name == wanted) return &v;
  return nullptr;
}

PosteriorGroup group_of(const std::string& name, const Draws& draws) {
  PosteriorGroup group{.name = name, .chains = draws.chains, .draws = draws.draws, .coordinates = {}, .variables = {}};
  for (std::size_t k = 0; k < draws.names.size(); ++k) group.variables.push_back({.name = draws.names[k], .unit = "", .dims = {}, .values = draws.of(k)});
  return group;
}

Draws draws_of(const PosteriorGroup& group) {
  Draws draws{.chains = group.chains, .draws = group.draws};
  std::vector<const std::vector<double>*> columns;
  for (const auto& v : group.variables)
    if (v.dims.empty() && v.values.size() == group.chains * group.draws) {
      draws.names.push_back(v.name);
      columns.push_back(&v.values);
    }
  for (std::size_t i = 0; i < group.chains * group.draws; ++i)
    for (const auto* c : columns) draws.values.push_back((*c)[i]);
  return draws;
}

std::vector<PosteriorGroup> posterior_groups(const std::vector<Parameter>& parameters, const SamplerResult& result) {
  using Kind = PosteriorVariable::Kind;
  PosteriorGroup posterior = group_of("posterior", result.quantities);
  for (auto& v : posterior.variables)
    for (const auto& p : parameters)
      if (p.name == v.name) v.unit = p.unit;
  PosteriorGroup stats{.name = "sample_stats", .chains = result.quantities.chains, .draws = result.quantities.draws, .coordinates = {}, .variables = {}};
  const auto add = [&](const char* name, const std::vector<double>& values, Kind kind) {
    stats.variables.push_back({.name = name, .unit = "", .dims = {}, .values = values, .kind = kind});
  };
  add("lp", result.log_density, Kind::real);
  add("acceptance_rate", result.acceptance, Kind::real);
  if (!result.energy.empty()) {
    std::vector<double> diverging = result.diverging;  // counts, because with thinning a draw has several transitions
    for (auto& d : diverging) d = d > 0;
    add("energy", result.energy, Kind::real);
    add("diverging", diverging, Kind::truth);
    add("tree_depth", result.depth, Kind::whole);
  }
  return {std::move(posterior), group_of("unconstrained_posterior", result.coordinates), std::move(stats)};
}

void write_posterior(const std::filesystem::path& path, const std::vector<PosteriorGroup>& groups, const Provenance& provenance) {
  NetcdfWriter file(path);
  file.attribute("title", "draws from a posterior, in the groups of ArviZ's schema");
  file.attribute("provenance", provenance.json().dump());
  for (const auto& group : groups) write_group(file, group);
  file.commit();
}

std::vector<PosteriorGroup> read_posterior(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const NetcdfReader file(path);
  std::vector<PosteriorGroup> groups;
  for (const auto& name : file.groups())
    if (names.empty() || std::find(names.begin(), names.end(), name) != names.end()) groups.push_back(read_group(file, name));
  for (const auto& name : names)
    if (std::none_of(groups.begin(), groups.end(), [&](const auto& g) { return g.name == name; }))
      throw InputError(
          {.problem = "has no group \"" + name + "\"", .suggestion = "it is no posterior.nc, or calomel sample did not write it", .file = path.string()});
  return groups;
}

Json posterior_json(const Convergence& convergence, const std::string& message, const SamplerResult& result, const Provenance& provenance) {
  Json json = convergence_json(convergence, message);
  const auto& s = result.summary;
  json["sampler"] = {{"kind", s.kind},
                     {"chains", result.quantities.chains},
                     {"draws", result.quantities.draws},
                     {"acceptance", s.acceptance},
                     {"evaluations", s.evaluations},
                     {"transitions", s.transitions},
                     {"wall_s", s.wall_s}};
  if (s.cheap_evaluations > 0) json["sampler"]["cheap_evaluations"] = s.cheap_evaluations;
  if (result.quantities.walkers > 1) json["sampler"]["walkers"] = result.quantities.walkers;
  if (s.log_evidence) json["sampler"]["log_evidence"] = *s.log_evidence;
  if (s.log_evidence_error) json["sampler"]["log_evidence_standard_error"] = *s.log_evidence_error;
  json["provenance"] = provenance.json();
  return json;
}

}  // namespace calomel
