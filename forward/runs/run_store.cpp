#include "forward/runs/run_store.hpp"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include "base/parallel.hpp"
#include "base/provenance.hpp"

namespace calomel {

namespace {

const std::string kind = "calomel runs 1";

}  // namespace

RunPoint point_at(std::span<const Parameter> parameters, std::span<const double> theta) {
  expect(parameters.size() == theta.size(), "a point has a value for every parameter");
  RunPoint point;
  for (std::size_t k = 0; k < theta.size(); ++k) point[parameters[k].key] = theta[k];
  expect(point.size() == theta.size(), "every parameter has a key of its own");
  return point;
}

std::vector<double> theta_at(std::span<const Parameter> parameters, const RunPoint& point) {
  std::vector<double> theta;
  for (const auto& p : parameters) {
    const auto at = point.find(p.key);
    expect(at != point.end(), "a run's point names every parameter");
    theta.push_back(at->second);
  }
  return theta;
}

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
    point[word.substr(0, equals)] = std::strtod(word.c_str() + equals + 1, nullptr);
  }
  return point;
}

RunStore::RunStore(const Provenance& provenance, const std::filesystem::path& path)
    : path_(path), file_(path, kind, provenance, [&](std::string_view payload, FrameFile::Place place) { places_[ByteReader(payload).text()] = place; }) {}

std::string RunStore::identity(const std::filesystem::path& path) { return FrameFile::identity(path, kind); }

void RunStore::make(std::span<const RunPoint> points, const Evaluate& evaluate, int threads, const Cost& cost, const Progress& progress,
                    const std::atomic<bool>* stop) {
  std::vector<const RunPoint*> missing;
  std::set<std::string> asked;  // a point that is asked for twice is run once
  for (const auto& p : points) {
    const auto [text, first] = asked.insert(text_of(p));
    if (!first) continue;
    const std::lock_guard guard(lock_);
    if (places_.contains(*text) || lost_.contains(*text))
      ++reused_;
    else
      missing.push_back(&p);
  }
  if (cost) std::stable_sort(missing.begin(), missing.end(), [&](const auto* a, const auto* b) { return cost(*a) > cost(*b); });
  std::size_t done = 0;
  if (progress && !missing.empty()) progress(0, missing.size());
  parallel_for(missing.size(), threads, [&](std::size_t k) {
    if (stop && stop->load()) return;
    const std::string text = text_of(*missing[k]);
    RunRecord record = evaluate(*missing[k]);
    FrameFile::Place place{};
    if (!record.lost) {
      ByteWriter payload;
      payload.text(text);
      payload.bytes += bytes_of(record);
      place = file_.append(payload.bytes);
    }
    const std::lock_guard guard(lock_);
    if (record.lost)
      lost_[text] = std::move(record);
    else
      places_[text] = place;
    ++done, ++made_;
    if (progress) progress(done, missing.size());
  });
  if (done < missing.size()) throw Interrupted();
}

std::vector<RunRecord> RunStore::run(std::span<const RunPoint> points, const Evaluate& evaluate, int threads, const Cost& cost, const Progress& progress,
                                     const std::atomic<bool>* stop) {
  make(points, evaluate, threads, cost, progress, stop);
  std::vector<RunRecord> records;
  records.reserve(points.size());
  for (const auto& p : points) records.push_back(read(p));
  return records;
}

bool RunStore::contains(const RunPoint& point) const {
  const std::lock_guard guard(lock_);
  return places_.contains(text_of(point));
}

RunRecord RunStore::read(const RunPoint& point) const {
  const std::string text = text_of(point);
  FrameFile::Place place;
  {
    const std::lock_guard guard(lock_);
    if (const auto lost = lost_.find(text); lost != lost_.end()) return lost->second;
    const auto at = places_.find(text);
    expect(at != places_.end(), "only a run that is held is read");
    place = at->second;
  }
  const std::string payload = file_.read(place);
  ByteReader in(payload);
  expect(in.text() == text, "a run is of the point that it is filed under");
  return record_of(in.rest());
}

std::vector<RunPoint> RunStore::points() const {
  const std::lock_guard guard(lock_);
  std::vector<RunPoint> points;
  for (const auto& [text, place] : places_) points.push_back(point_of(text));
  return points;
}

std::size_t RunStore::size() const {
  const std::lock_guard guard(lock_);
  return places_.size();
}

std::size_t RunStore::lost() const {
  const std::lock_guard guard(lock_);
  return lost_.size();
}

bool RunStore::lost(const RunPoint& point) const {
  const std::lock_guard guard(lock_);
  return lost_.contains(text_of(point));
}

void RunStore::remove() {
  std::error_code error;
  std::filesystem::remove(path_, error);
  if (error) throw InputError({.problem = "cannot be removed: " + error.message(), .file = path_.string()});
}

}  // namespace calomel
