#pragma once
/// The greatest stable time step, from the whole mesh rather than from its worst element.
#include "forward/solver/run.hpp"

namespace calomel {

/// Greatest stable central-difference step, 2/omega (sqrt(1 + xi^2) - xi), of an element with eigenvalue omega^2
/// [1/s^2] and stiffness-proportional damping beta [s] that lags half a step (xi = beta omega / 2) [s].
double stable_time_step(double eigenvalue, double beta);

/// The same of motion whose velocities are multiplied by f = exp(-a dt) after each step, where `step` is stable without that: from
/// z^2 - (1 + f - dt^2 omega^2) z + f = 0, dt^2 omega^2 < 2 (1 + f); f is taken at `step`, on the safe side. `mass_damping` a [1/s], step [s].
double mass_damped_time_step(double step, double mass_damping);

/// Stable step of a run made with `run`'s own step, which must itself be stable [s]. Central differences with damping C that lags
/// half a step are stable while 4 M - 2 dt C - dt^2 K is positive definite, so dt^2 lambda = 4 with lambda the greatest eigenvalue
/// of K + 2 C / dt against M; taking 2 C / dt at the shorter step of the run only adds to it. lambda is found by Lanczos' method
/// with the mass inner product, in every lane from a random start of its own, and raised by the residual of its Ritz vector.
/// Deterministic. Where wetted faces may part they are apart. `liquid_alone`: of the liquid, the steel being no more than mass.
template <class R>
double global_stable_step(const Run<R>& run, int threads, bool liquid_alone = false);

extern template double global_stable_step<float>(const Run<float>&, int, bool);
extern template double global_stable_step<double>(const Run<double>&, int, bool);

}  // namespace calomel
