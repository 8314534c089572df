#pragma once
/// A step of a diagnosis: the fit of one explanation in the true model, and the explanation to first order where there is no fit.
#include <optional>

#include "uq/diagnosis/fit_library.hpp"

namespace calomel {

/// Fits a candidate of `group` beside the base model's parameters, or beside those of `on_top_of`. `best`: greatest log Bayes factor so far, which the
/// explanation may lead while its fit goes on. The fit is put into the library under the explanation's name; the explanation is returned. Nothing where the
/// budget does not allow the runs that the fit begins with, which is noted there. A fit that fails leaves an explanation without a fit.
[[nodiscard]] std::optional<Alternative> fit_explanation(const FitContext& context, const ParameterGroup& group, const ScreenedCandidate& screened,
                                                         const Alternative* on_top_of, double best);

/// The explanation to first order about the base fit.
[[nodiscard]] Alternative first_order_explanation(const DiagnosisInputs& in, const BaseFit& base, const ParameterGroup& group,
                                                  const ScreenedCandidate& screened);

}  // namespace calomel
