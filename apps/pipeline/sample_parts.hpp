#pragma once
/// What sampling a posterior on an emulator and sampling a model itself share.
#include <string>
#include <vector>

#include "forward/parameter.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/posterior_file.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// A sentence for every parameter whose posterior lies more than two prior standard deviations from its prior's middle.
std::vector<std::string> absorption(const std::vector<Parameter>& parameters, const Convergence& convergence);
/// Of a sampler's draws.
Convergence assessed(const SamplerResult& result, int thin);

}  // namespace calomel
