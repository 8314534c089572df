#include "forward/simulation/runs.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace calomel {

void Runs::make(std::span<const RunRequest> requests, const Progress& progress) {
  std::map<std::string, std::size_t> place;  // of each run among the missing ones
  std::set<std::string> held;
  std::vector<RunRequest> missing;
  for (const auto& r : requests) {
    const std::string text = run_text(r);
    if (store_.lost(r) || store_.holds(r)) {
      if (held.insert(text).second) ++reused_;
      continue;
    }
    const auto [at, first] = place.emplace(text, missing.size());
    if (first)
      missing.push_back(r);
    else
      missing[at->second].wanted = missing[at->second].wanted.with(r.wanted);
  }
  if (missing.empty()) return;
  std::stable_sort(missing.begin(), missing.end(), [&](const auto& a, const auto& b) { return simulator_.cost(a) > simulator_.cost(b); });
  std::size_t done = 0;
  if (progress) progress(0, missing.size());
  executor_.make(
      simulator_, missing,
      [&](std::size_t i, RunRecord record) {
        failed_ += !record.done;
        store_.keep(missing[i], std::move(record));
        ++done;
        ++made_;
        if (progress) progress(done, missing.size());
      },
      stop_);
  if (done < missing.size()) throw Interrupted();
}

std::vector<RunRecord> Runs::get(std::span<const RunRequest> requests, const Progress& progress) {
  make(requests, progress);
  std::vector<RunRecord> records;
  records.reserve(requests.size());
  for (const auto& r : requests) records.push_back(store_.read(r));
  return records;
}

std::vector<RunRequest> wanting(std::span<const RunRequest> requests, const Outputs& wanted) {
  std::vector<RunRequest> all(requests.begin(), requests.end());
  for (auto& r : all) r.wanted = wanted;
  return all;
}

}  // namespace calomel
