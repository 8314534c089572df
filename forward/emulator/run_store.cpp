#include "forward/emulator/run_store.hpp"

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <sstream>

#include "base/parallel.hpp"
#include "base/provenance.hpp"

namespace calomel {

namespace {

/// FNV-1a over the text: where the journal keeps the run.
std::size_t number_of(const std::string& text) {
  std::uint64_t h = 14695981039346656037ull;
  for (const char c : text) h = (h ^ std::uint8_t(c)) * 1099511628211ull;
  return h;
}

}  // namespace

std::string text_of(const RunPoint& point) {
  std::string text;
  for (const auto& [key, value] : point) text += (text.empty() ? "" : " ") + key + '=' + number_text(value);
  return text.empty() ? "case" : text;
}

RunPoint point_of(const std::string& text) {
  RunPoint point;
  std::istringstream words(text == "case" ? "" : text);
  for (std::string word; words >> word;) {
    const auto equals = word.find('=');
    expect(equals != std::string::npos, "a run's text holds keys and values");
    point[word.substr(0, equals)] = std::stod(word.substr(equals + 1));
  }
  return point;
}

RunStore::RunStore(const Provenance& provenance, const std::filesystem::path& directory) : journal_(directory / "runs.journal", provenance) {}

std::vector<StoredRun> RunStore::run(std::span<const RunPoint> points, const Evaluate& evaluate, int threads, const Cost& cost, const Progress& progress,
                                     const std::atomic<bool>* stop) {
  std::vector<StoredRun> runs(points.size());
  std::vector<std::size_t> missing;
  std::map<std::string, std::size_t> first;  // a point that is asked for twice is run once
  for (std::size_t i = 0; i < points.size(); ++i) {
    runs[i].point = points[i];
    const std::string text = text_of(points[i]);
    if (!first.emplace(text, i).second) continue;
    if (const auto at = number_of(text); journal_.contains(at)) {
      runs[i].record = journal_.read(at), ++reused_;
      expect(runs[i].record.point == text, "no two points of a study share a number");
    } else {
      missing.push_back(i);
    }
  }
  if (cost)
    std::stable_sort(missing.begin(), missing.end(), [&](std::size_t a, std::size_t b) { return cost(points[a]) > cost(points[b]); });
  std::mutex lock;
  std::size_t done = 0;
  parallel_for(missing.size(), threads, [&](std::size_t k) {
    if (stop && stop->load()) return;
    StoredRun& r = runs[missing[k]];
    r.record = evaluate(r.point);
    r.record.point = text_of(r.point);
    journal_.append(number_of(r.record.point), r.record);
    const std::lock_guard guard(lock);
    ++done, ++made_;
    if (progress) progress(done, missing.size());
  });
  if (done < missing.size()) throw Interrupted();
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (const auto at = first.at(text_of(points[i])); at != i) runs[i].record = runs[at].record;
  return runs;
}

std::vector<StoredRun> RunStore::all() const {
  std::vector<StoredRun> runs;
  for (const auto number : journal_.runs()) {
    RunRecord record = journal_.read(number);
    runs.push_back({point_of(record.point), std::move(record)});
  }
  std::sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.record.point < b.record.point; });
  return runs;
}

}  // namespace calomel
