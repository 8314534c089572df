#include "uq/sampler/sampler_options.hpp"

#include "base/json.hpp"

namespace calomel {

std::vector<SamplerTable> sampler_tables(const Registry<SamplerEntry>& catalogue) {
  std::vector<SamplerTable> tables;
  for (const auto& row : catalogue.rows()) tables.push_back({.name = row.name, .options = row.entry.options});
  return tables;
}

SamplerOptions default_sampler_options(const std::string& kind, bool external, const Registry<SamplerEntry>& catalogue) {
  const SamplerEntry& entry = catalogue.get(kind, "sampler.kind");
  const ChainLengths lengths = external ? entry.external_lengths.value_or(entry.lengths) : entry.lengths;
  return {.kind = kind, .warmup = lengths.warmup, .draws = lengths.draws, .thin = lengths.thin, .tables = sampler_tables(catalogue), .catalogue = &catalogue};
}

SamplerOptions one_density_options(const SamplerOptions& options) {
  const std::string& first_stage = options.entry().first_stage;
  return first_stage.empty() ? options : default_sampler_options(first_stage, false, *options.catalogue);
}

Json identity_options(const SamplerOptions& options) {
  const SamplerEntry& entry = options.entry();
  Json json = echo(options);
  for (const auto& table : options.tables)
    if (table.name != options.kind && table.name != entry.first_stage) json.erase(table.name);
  for (const auto& key : entry.limits) json[options.kind].erase(key);
  return json;
}

double usual_evaluations(const SamplerOptions& options, std::size_t dimension) {
  return double(options.chains) * (double(options.warmup) + double(options.draws) * options.thin) * options.entry().evaluations(options, dimension);
}

}  // namespace calomel
