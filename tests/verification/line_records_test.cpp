// The line model on measured records of ../shared/data (sources in its README): which mechanism explains them, and the remaining residual.
#include <fmt/format.h>
#include <gsl/gsl_multimin.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>

#include "forward/line/bar_wave.hpp"
#include "forward/line/line_model.hpp"
#include "forward/line/pochhammer_chree.hpp"
#include "tests/shared_data.hpp"
#include "tests/verification/rows.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

const std::string item = "Line on measured records";
using Numbers = std::map<std::string, double>;

std::filesystem::path data() { return shared_folder(CALOMEL_SOURCE_DIR) / "data"; }

struct Fit {
  std::vector<double> x;
  double rms = 0;
};

/// Minimum of f by Nelder and Mead's simplex (GSL's nmsimplex2), started twice.
Fit least(const std::function<double(const std::vector<double>&)>& f, std::vector<double> x, const std::vector<double>& steps, int iterations = 120) {
  const std::size_t n = x.size();
  using Vector = std::unique_ptr<gsl_vector, decltype(&gsl_vector_free)>;
  const auto plain = [](const gsl_vector* v) {
    std::vector<double> y(v->size);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = gsl_vector_get(v, i);
    return y;
  };
  static thread_local const std::function<double(const std::vector<double>&)>* objective;
  objective = &f;
  gsl_multimin_function g{[](const gsl_vector* v, void*) {
                            std::vector<double> y(v->size);
                            for (std::size_t i = 0; i < y.size(); ++i) y[i] = gsl_vector_get(v, i);
                            return (*objective)(y);
                          },
                          n, nullptr};
  double value = 0;
  for (int restart = 0; restart < 2; ++restart) {
    Vector at(gsl_vector_alloc(n), gsl_vector_free), step(gsl_vector_alloc(n), gsl_vector_free);
    for (std::size_t i = 0; i < n; ++i) gsl_vector_set(at.get(), i, x[i]), gsl_vector_set(step.get(), i, steps[i]);
    const std::unique_ptr<gsl_multimin_fminimizer, decltype(&gsl_multimin_fminimizer_free)> search(
        gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, n), gsl_multimin_fminimizer_free);
    gsl_multimin_fminimizer_set(search.get(), &g, at.get(), step.get());
    for (int i = 0; i < iterations && !gsl_multimin_fminimizer_iterate(search.get()); ++i)
      if (gsl_multimin_fminimizer_size(search.get()) < 1e-6) break;
    x = plain(search->x);
    value = search->fval;
  }
  return {x, value};
}

LineModel model_of(const std::string& text) {
  CaseFile file = CaseFile::from_text(text);
  return LineModel(LineCase::read(file));
}

constexpr double sample = 3.3e-7, bar_speed = 5357, bar_radius = 0.01, travel = 1.178;

}  // namespace

// Two gauges on bars pressed together: the first drives, the second is compared over 250 to 420 us. Delay, gain and each mechanism's number are fitted.
TEST(LineRecords, DispersionOfTheBarIsLateralInertias) {
  const auto path = data() / "hopkinson_bar" / "disp_check.dat";
  if (!std::filesystem::exists(path)) {
    rows_absent(absent_from_shared(path));
    GTEST_SKIP() << absent_from_shared(path);
  }
  const LineModel model = model_of(
      fmt::format("[case]\nsensor_unit = \"V\"\n[model]\nkind = \"line\"\n[line]\nkind = \"bar\"\nwave_speed = {}\nradius = {}\n[drive]\nfile = \"{}\"\n"
                  "sample_interval = {}\nbaseline = 4.95e-5\n[time]\nend = 4.95e-4\noutput_interval = {}\n[[station]]\nname = \"out\"\ndistance = {}\n",
                  bar_speed, bar_radius, path.string(), sample, sample, travel));
  const Signal record = read_drive(path, {.column = 3, .sample_interval = sample, .baseline = 4.95e-5});
  const auto misfit = [&](std::span<const double> history) {  // with the best gain [mV]
    double hh = 0, hy = 0, yy = 0;
    int n = 0;
    for (std::size_t i = 0; i < history.size(); ++i) {
      if (double(i) * sample < 250e-6 || double(i) * sample > 420e-6) continue;
      hh += history[i] * history[i];
      hy += history[i] * record.value[i];
      yy += record.value[i] * record.value[i];
      ++n;
    }
    return 1e3 * std::sqrt((yy - hy * hy / hh) / n);
  };
  const auto fit = [&](const std::string& key, double scale, double begin, double step) {
    return least(
        [&](const std::vector<double>& x) {
          Numbers numbers{{"station.out.delay", 1e-6 * x[0]}};
          if (x.size() > 1) numbers[key] = scale * x[1];
          const auto p = x.size() > 1 && x[1] < 0 ? Prediction{.ok = false} : model.evaluate({}, numbers);
          return p.ok ? misfit(p.mean) : 1e3;
        },
        key.empty() ? std::vector<double>{0} : std::vector<double>{0, begin}, key.empty() ? std::vector<double>{3} : std::vector<double>{3, step});
  };
  const Fit base = fit("", 0, 0, 0), lag = fit("mechanism.sensor_response.lag", 1e-6, 1, 1), viscous = fit("mechanism.viscous_attenuation.time", 1e-9, 10, 10),
            low_pass = fit("mechanism.sensor_response.low_pass", 1e3, 60, 30), inertia = fit("mechanism.lateral_inertia.poisson", 1, 0.25, 0.05);
  const Fit love = least(
      [&](const std::vector<double>& x) {
        const BarWave wave(model.line_case().record, 300e-6);
        std::vector<std::complex<double>> k;
        for (const double w : wave.omega()) {
          const double c = bar_speed * love_speed(w * bar_radius / bar_speed, x[1]);
          k.push_back(c > 0 ? std::complex<double>(w / c) : std::complex<double>(0, -1e3));  // no waves above the cut-off frequency
        }
        auto there = wave.at(travel, k, 1e-6 * x[0]);
        there.resize(model.shape().times.size());
        return misfit(there);
      },
      {0, 0.25}, {3, 0.05});
  const auto print_row = [&](const char* what, double measured, double reference, double tolerance) {
    verify({.item = item,
            .quantity = fmt::format("bar: residual, {}", what),
            .unit = "mV",
            .reference = reference,
            .source = "computed independently",
            .measured = measured,
            .tolerance = tolerance,
            .control = "the rows of the other laws, whose residuals differ"});
  };
  print_row("1-D bar", base.rms, 27.4, 0.15);
  print_row("sensor lag", lag.rms, 25.5, 0.15);
  print_row("viscous attenuation", viscous.rms, 23.7, 0.15);
  print_row("Love's rod", love.rms, 17.4, 0.6);
  print_row("Pochhammer and Chree", inertia.rms, 16.1, 0.15);
  verify({.item = item,
          .quantity = "bar: Poisson's ratio found by lateral_inertia",
          .reference = 0.285,
          .source = "fitted independently, +- 0.015; steel 0.25 to 0.31",
          .measured = inertia.x[1],
          .tolerance = 0.015,
          .control = "the same by Love's rod",
          .control_value = love.x[1]});
  std::cout << fmt::format("low pass of second order: {:.2f} mV at {:.1f} kHz; Love's rod nu {:.3f}\n", low_pass.rms, low_pass.x[1], love.x[1]);
  for (const Fit* other : {&base, &lag, &viscous, &low_pass, &love}) EXPECT_GT(other->rms, inertia.rms + 0.5);
}

// Gauge pressure at a closing valve of Adelaide's rig (37.23 m, 22.1 mm, 1.4 m/s, 22 m of head, the valve 2.03 m above) with column separation. Its points
// are sorted in time and compared at even times of 1 ms.
TEST(LineRecords, ColumnSeparationIsTheVapourCutoffs) {
  const auto path = data() / "water_hammer" / "severe_valve_trace.csv";
  if (!std::filesystem::exists(path)) {
    rows_absent(absent_from_shared(path));
    GTEST_SKIP() << absent_from_shared(path);
  }
  std::vector<std::pair<double, double>> points, without;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    double t = 0, p = 0;
    char comma = 0;
    if (std::istringstream s(line); s >> t >> comma >> p) points.emplace_back(t, p);
  }
  std::sort(points.begin(), points.end());
  // Six points lie evenly spaced at 2.06 MPa after the pressure has fallen to that of vapour: they are a line of the figure and not of the record.
  for (const auto& p : points)
    if (!(p.first > 0.446 && p.first < 0.480 && p.second > 1000)) without.push_back(p);
  EXPECT_EQ(points.size() - without.size(), 6u);
  const LineModel model = model_of(
      "[case]\nsensor_unit = \"kPa\"\n[model]\nkind = \"line\"\n[line]\nkind = \"pipe\"\nlength = 37.23\ndiameter = 0.0221\nwave_speed = 1319\nvelocity = "
      "1.4\nreservoir_pressure = 215.4e3\n"
      "closure_time = 0.009\nrise = 2.03\ncells = 32\n[time]\nend = 0.8\noutput_interval = 0.0005\n[[station]]\nname = \"valve\"\ndistance = 37.23\n");
  const auto misfit = [](const std::vector<std::pair<double, double>>& record, const std::vector<double>& history) {
    double sum = 0;
    int n = 0;
    for (std::size_t k = 0; n < 798; ++n) {
      const double t = 0.0015 + 0.001 * n;
      while (record[k + 1].first < t) ++k;
      const double w = (t - record[k].first) / (record[k + 1].first - record[k].first), y = (1 - w) * record[k].second + w * record[k + 1].second;
      sum += std::pow(history[std::size_t(std::llround(t / 0.0005))] - y, 2);
    }
    return std::sqrt(sum / n);
  };
  const auto at = [&](const Numbers& numbers) {
    const auto p = model.evaluate({}, numbers);
    return p.ok ? p.mean : std::vector<double>(model.shape().times.size(), 1e4);
  };
  const auto fit = [&](const std::vector<std::string>& keys, std::vector<double> x, const std::vector<double>& steps, const Numbers& fixed) {
    return least(
        [&](const std::vector<double>& y) {
          Numbers numbers = fixed;
          for (std::size_t i = 0; i < y.size(); ++i) numbers[keys[i]] = y[i];
          return misfit(points, at(numbers));
        },
        x, steps);
  };
  const std::string speed = "line.wave_speed", friction = "line.friction_factor";
  const Numbers cutoff{{"mechanism.vapour_cutoff.pressure", -99e3}},
      any_friction{{"line.outlet_pressure", -1e9}};  // a valve pressure that makes even absurd friction steady
  const auto nominal = at(cutoff);
  const Fit elastic = fit({speed, friction}, {1319, 0.3}, {60, 0.2}, any_friction), vapour = fit({speed, friction}, {1319, 0.0236}, {60, 0.01}, cutoff),
            unsteady = fit({speed, friction, "mechanism.unsteady_friction.strength"}, {1319, 0.3, 5}, {60, 0.2, 5}, any_friction),
            wall = fit({speed, friction, "mechanism.wall_viscoelasticity.compliance"}, {1319, 0.3, 0.2}, {60, 0.2, 0.1}, any_friction),
            lag = fit({speed, friction, "mechanism.sensor_response.lag"}, {1319, 0.3, 0.02}, {60, 0.2, 0.02}, any_friction);
  Numbers fitted = cutoff, level = cutoff;
  fitted[speed] = vapour.x[0];
  fitted[friction] = vapour.x[1];
  level["line.rise"] = 0;
  const auto returns = [&](const std::vector<double>& history) {  // when the pressure returns
    for (std::size_t i = 400;; ++i)
      if (history[i] > 200) return model.shape().times[i];
  };
  std::cout << fmt::format(
      "cutoff at nominal numbers: {:.0f} kPa rms, {:.0f} without the points of the figure; fitted {:.0f} and {:.0f} at {:.0f} m/s, friction {:.4f}\n",
      misfit(points, nominal), misfit(without, nominal), vapour.rms, misfit(without, at(fitted)), vapour.x[0], vapour.x[1]);
  std::cout << fmt::format(
      "elastic {:.0f} kPa at friction {:.3f}; unsteady friction {:.0f} (strength {:.1f}), retarded wall {:.0f} (compliance {:.2f}), lag {:.0f} ({:.3f} s); "
      "back at {:.4f} s, level pipe {:.4f} s\n",
      elastic.rms, elastic.x[1], unsteady.rms, unsteady.x[2], wall.rms, wall.x[2], lag.rms, lag.x[2], returns(nominal), returns(at(level)));
  verify({.item = item,
          .quantity = "water hammer: residual of the best elastic line",
          .unit = "kPa",
          .reference = 732,
          .source = "computed independently, with an unrealistic friction factor",
          .measured = elastic.rms,
          .tolerance = 10,
          .control = "with the cutoff",
          .control_value = vapour.rms});
  verify({.item = item,
          .quantity = "water hammer: time at which the pressure returns, cutoff at nominal numbers",
          .unit = "s",
          .reference = 0.383,
          .source = "the record (Bergant and Simpson 1999)",
          .measured = returns(nominal),
          .tolerance = 0.006,
          .control = "level pipe",
          .control_value = returns(at(level))});
  verify({.item = item,
          .quantity = "water hammer: residual with the cutoff over that of the elastic line",
          .reference = 369.0 / 732,
          .source = "computed independently, for a level pipe",
          .measured = vapour.rms / elastic.rms,
          .tolerance = 0.1,
          .control = "retarded wall instead",
          .control_value = wall.rms / elastic.rms});
  for (const Fit* other : {&elastic, &unsteady, &wall, &lag}) EXPECT_GT(other->rms, 1.5 * vapour.rms);
  EXPECT_GT(vapour.x[1], 0.01);
  EXPECT_LT(vapour.x[1], 0.04);
  EXPECT_GT(elastic.x[1], 0.2);  // absurd: the steady flow would lose more pressure than is available
}
