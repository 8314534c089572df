#include "tests/bench/element_work.hpp"

#include <type_traits>

#include "forward/solver/hexahedron.hpp"
#include "forward/solver/packed_mesh.hpp"

#define CALOMEL_INLINE inline __attribute__((always_inline))

namespace calomel {

namespace counted {

#include "forward/solver/kernel_simd.hpp"
#include "forward/solver/kernel_elements.hpp"

/// A number whose operations are counted. One that is known beforehand costs nothing together with another such; nor does adding zero or multiplying by one.
class Counted {
 public:
  Counted() = default;
  Counted(double value) : value_(value) {}
  static Counted measured(double value) {
    Counted c(value);
    c.known_ = false;
    return c;
  }
  static int operations;

  friend Counted operator+(const Counted& a, const Counted& b) { return a.is(0) ? b : b.is(0) ? a : make(a.value_ + b.value_, a, b); }
  friend Counted operator-(const Counted& a, const Counted& b) { return a.is(0) ? -b : b.is(0) ? a : make(a.value_ - b.value_, a, b); }
  friend Counted operator*(const Counted& a, const Counted& b) {
    return a.is(0) || b.is(0) ? Counted() : a.is(1) ? b : b.is(1) ? a : make(a.value_ * b.value_, a, b);
  }
  friend Counted operator/(const Counted& a, const Counted& b) { return b.is(1) ? a : make(a.value_ / b.value_, a, b); }
  Counted operator-() const {
    Counted c = *this;
    c.value_ = -value_;
    return c;
  }
  Counted& operator+=(const Counted& b) { return *this = *this + b; }
  Counted& operator-=(const Counted& b) { return *this = *this - b; }
  friend bool operator>(const Counted& a, const Counted& b) { return a.value_ > b.value_; }
  friend bool operator<=(const Counted& a, const Counted& b) { return a.value_ <= b.value_; }
  friend bool operator<(const Counted& a, const Counted& b) { return a.value_ < b.value_; }
  double& operator[](int) { return value_; }

 private:
  [[nodiscard]] bool is(double value) const { return known_ && value_ == value; }
  static Counted make(double value, const Counted& a, const Counted& b) {
    if (a.known_ && b.known_) return {value};
    ++operations;
    return measured(value);
  }

  double value_ = 0;
  bool known_ = true;
};
int Counted::operations = 0;

/// Operations of `body`.
template <class Body>
int operations(Body&& body) {
  const int before = Counted::operations;
  body();
  return Counted::operations - before;
}

template <std::size_t N>
void measure_all(Counted (&a)[3][N]) {
  for (auto& row : a)
    for (auto& x : row) x = Counted::measured(0.5);
}

template <bool Liquid, Form F>
ElementWork work() {
  constexpr bool affine = F == Form::parallelepiped;
  const Counted any = Counted::measured(0.5), constant(0.3);  // of the element, of the run
  const auto geometry = [&](int) { return any; };
  Counted corners[3][8], modes[3][8], grad[3][3], t[3][3], forces[3][8];
  measure_all(corners);
  measure_all(modes);
  measure_all(forces);
  Sums<Counted> sums;
  LiquidStep<Counted> step;
  step.bulk_modulus = step.minus_cutoff = step.hourglass = constant;
  step.p0 = any;
  ElementWork w;
  w.to_modes = 3 * operations([&] { to_modes(corners[0], modes[0]); });
  w.to_corners = 3 * operations([&] { to_corners(forces[0], corners[0]); }) + 24;  // each corner's force is added to its node's
  measure_all(modes);
  if constexpr (F == Form::dense) {
    w.law = operations([&] { dense_element<false>(modes, forces, geometry, sums); });
    return w;
  } else {
    w.gradients = operations([&] { gradients<affine>(modes, geometry, grad); });
    int element = 0;
    if constexpr (Liquid) {
      w.law = operations([&] { any* liquid_pressure<Keep::nothing, false>(volumetric_strain<F>(grad), any, step, static_cast<Counted*>(nullptr), sums); });
      element = operations([&] { liquid_element<F, Keep::nothing, false>(modes, forces, geometry, step, static_cast<Counted*>(nullptr), sums); });
    } else {
      w.law = operations([&] { steel_stress<F, false>(grad, any, constant, constant, t, static_cast<Counted*>(nullptr), sums); });
      element = operations([&] { steel_element<F, false>(modes, forces, geometry, constant, constant, static_cast<Counted*>(nullptr), sums); });
    }
    if constexpr (Liquid && affine) {
      w.spread = 9;  // the pressure alone times nine gradients
    } else {
      measure_all(t);
      w.spread = operations([&] { spread<affine>(t, geometry, forces); });
    }
    w.hourglass = element - w.gradients - w.law - w.spread;
    if (Liquid) ++w.law;  // p0 of the element times the share that is put in
    return w;
  }
}

}  // namespace counted

ElementWork element_work(bool liquid, Form form) {
  using counted::work;
  switch (form) {
    case Form::parallelepiped:
      return liquid ? work<true, Form::parallelepiped>() : work<false, Form::parallelepiped>();
    case Form::finite:
      return liquid ? work<true, Form::finite>() : work<false, Form::finite>();
    case Form::dense:
      return work<false, Form::dense>();
    default:
      return liquid ? work<true, Form::general>() : work<false, Form::general>();
  }
}

MeshWork mesh_work(const Mesh& mesh, std::size_t real, bool runs) {
  double flops[2][2];
  for (const bool liquid : {false, true})
    for (const bool affine : {false, true}) flops[liquid][affine] = element_work(liquid, affine ? Form::parallelepiped : Form::general).total();
  MeshWork sum;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const bool liquid = mesh.region[e] == Region::mercury, affine = hex_geometry(corners_of(mesh, e)).parallelepiped;
    sum.flops += flops[liquid][affine];
    sum.bytes += double(geometry_terms(liquid, affine ? Form::parallelepiped : Form::general)) * double(real) / (runs ? run_lanes : 1);
  }
  const double elements = double(mesh.elements.size()), nodes = double(mesh.nodes.size()) / elements;
  return {.flops = sum.flops / elements + nodes * (node_viscosity_work + node_advance_work),
          .bytes = sum.bytes / elements + 16.0 / (runs ? run_lanes : 1) + nodes * double(real) * (runs ? 3 : 4) * 4};
}

}  // namespace calomel
