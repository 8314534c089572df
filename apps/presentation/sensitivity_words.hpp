#pragma once
/// Sentences about an analysis of sensitivity: what was evaluated, and how far its shares are to be trusted.
#include <string>
#include <vector>

#include "uq/sensitivity/sensitivity.hpp"

namespace calomel {

/// What was evaluated: a surrogate of these runs, or, where `runs` is null, the model itself.
[[nodiscard]] std::string evaluated_sentence(const KnownRuns* runs);
/// Why the shares are not to be trusted; empty where they are. upstream_trusted: of the campaign and the surrogate.
[[nodiscard]] std::string sensitivity_doubt(const Sensitivity& sensitivity, bool upstream_trusted);
/// The polynomial that was evaluated for a total in place of the model; empty where it was the model.
[[nodiscard]] std::string total_source(const QuantitySensitivity& quantity);
/// Why a quantity has no shares, or why they are unreliable; empty where they are reliable. parameters: their number.
[[nodiscard]] std::string share_note(const QuantitySensitivity& quantity, std::size_t parameters);

/// All sentences of sensitivity.json.
[[nodiscard]] SensitivityWords sensitivity_words(const Sensitivity& sensitivity, std::size_t parameters, const KnownRuns* runs, bool upstream_trusted);
/// The lines for the terminal: one a parameter, one a total, the doubt, the number of evaluations.
[[nodiscard]] std::vector<std::string> sensitivity_lines(const Sensitivity& sensitivity, const SensitivityWords& words,
                                                         const std::vector<Parameter>& parameters);

}  // namespace calomel
