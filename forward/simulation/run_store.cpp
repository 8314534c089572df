#include "forward/simulation/run_store.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/provenance.hpp"

namespace calomel {

namespace {

const std::string kind = "calomel runs 2";
const std::string first_kind = "calomel runs 1";

constexpr std::array<bool Outputs::*, 4> outputs_by_bit{&Outputs::mean, &Outputs::pulses, &Outputs::energy_balance, &Outputs::totals};

std::uint8_t byte_of(const Outputs& outputs) {
  unsigned byte = 0;
  for (std::size_t bit = 0; bit < outputs_by_bit.size(); ++bit) byte |= unsigned(outputs.*outputs_by_bit[bit]) << bit;
  return std::uint8_t(byte);
}

Outputs outputs_of(std::uint8_t byte) {
  Outputs outputs;
  for (std::size_t bit = 0; bit < outputs_by_bit.size(); ++bit) outputs.*outputs_by_bit[bit] = ((byte >> bit) & 1u) != 0;
  return outputs;
}

std::string payload_of(const std::string& text, const Outputs& outputs, const RunRecord& record) {
  ByteWriter payload;
  payload.text(text);
  payload.value(byte_of(outputs));
  payload.bytes += bytes_of(record);
  return std::move(payload.bytes);
}

/// The request of a run of a version 1 journal, whose text has flags and the mesh among the numbers.
RunRequest request_of_first(const std::string& text) {
  RunRequest request = request_of(text);
  const auto take = [&](const char* key) {
    const auto at = request.numbers.find(key);
    if (at == request.numbers.end()) return std::optional<double>();
    const double value = at->second;
    request.numbers.erase(at);
    return std::optional(value);
  };
  if (take("campaign.keep_pulses")) request.wanted.pulses = true;
  if (take("solver.energy_balance")) request.wanted = {.mean = false, .totals = true};
  if (request.numbers.contains("material.mercury.regularising_viscosity")) request.element_size = take("geometry.element_size");
  return request;
}

/// The record with the wanted outputs alone, so that it does not depend on what else was requested before.
RunRecord only(const Outputs& wanted, RunRecord record) {
  if (!wanted.mean)
    for (auto* values : {&record.mean, &record.energy_slope, &record.scatter}) values->clear();
  if (!wanted.mean) record.exact.clear();
  if (!wanted.pulses) record.pulses.clear();
  if (!wanted.pulses) record.energies.clear();
  if (!wanted.totals) record.totals.clear();
  if (!wanted.energy_balance) record.energy_balance.clear();
  return record;
}

/// Rewrites a version 1 journal as version 2. A kill at any instant leaves one of the two whole.
void rewrite_first_version(const Provenance& provenance, const std::filesystem::path& path) {
  std::filesystem::path rewritten = path;
  rewritten += ".rewritten";
  std::filesystem::remove(rewritten);
  try {
    FrameFile next(rewritten, kind, provenance, [](std::string_view, FrameFile::Place) {});
    const FrameFile first(path, first_kind, provenance, [&](std::string_view payload, FrameFile::Place) {
      ByteReader in(payload);
      const RunRequest request = request_of_first(in.text());
      (void)next.append(payload_of(run_text(request), request.wanted, record_of(in.rest())));
    });
  } catch (...) {  // the journal of another case, or one in use, is not changed
    std::filesystem::remove(rewritten);
    throw;
  }
  std::filesystem::rename(rewritten, path);
}

}  // namespace

RunStore::RunStore() = default;

RunStore::RunStore(const Provenance& provenance, const std::filesystem::path& path) {
  if (!FrameFile::identity(path, first_kind).empty()) rewrite_first_version(provenance, path);
  file_.emplace(path, kind, provenance, [&](std::string_view payload, FrameFile::Place place) {
    ByteReader in(payload);
    const std::string text = in.text();
    held_[text].push_back({.outputs = outputs_of(in.value<std::uint8_t>()), .place = place, .record = {}});
  });
}

std::string RunStore::identity(const std::filesystem::path& path) {
  const std::string now = FrameFile::identity(path, kind);
  return now.empty() ? FrameFile::identity(path, first_kind) : now;
}

bool RunStore::holds(const RunRequest& request) const {
  const std::lock_guard guard(lock_);
  const auto at = held_.find(run_text(request));
  if (at == held_.end()) return false;
  Outputs all{.mean = false};
  for (const auto& h : at->second) all = all.with(h.outputs);
  return all.cover(request.wanted);
}

RunRecord RunStore::read(const std::string& text, const Held& held) const {
  if (held.record) return *held.record;
  const std::string payload = file_->read(held.place);
  ByteReader in(payload);
  expect(in.text() == text, "a run is of the text that it is filed under");
  (void)in.value<std::uint8_t>();
  return record_of(in.rest());
}

RunRecord RunStore::read(const RunRequest& request) const {
  const std::string text = run_text(request);
  std::vector<Held> all;
  {
    const std::lock_guard guard(lock_);
    if (const auto lost = lost_.find(text); lost != lost_.end()) return lost->second;
    const auto at = held_.find(text);
    expect(at != held_.end(), "only a run that is held is read");
    all = at->second;
  }
  for (auto h = all.rbegin(); h != all.rend(); ++h)
    if (h->outputs.cover(request.wanted)) return only(request.wanted, read(text, *h));
  // The outputs come from several frames: of each output the newest.
  RunRecord record{.done = true};
  Outputs there{.mean = false};
  for (auto h = all.rbegin(); h != all.rend() && !there.cover(request.wanted); ++h) {
    RunRecord part = read(text, *h);
    if (!part.done) {
      record.done = false;
      if (record.message.empty()) record.message = part.message;
    }
    if (h->outputs.mean && !there.mean) {
      record.mean = std::move(part.mean);
      record.energy_slope = std::move(part.energy_slope);
      record.scatter = std::move(part.scatter);
      record.exact = std::move(part.exact);
    }
    if (h->outputs.pulses && !there.pulses) {
      record.pulses = std::move(part.pulses);
      record.energies = std::move(part.energies);
    }
    if (h->outputs.totals && !there.totals) record.totals = std::move(part.totals);
    if (h->outputs.energy_balance && !there.energy_balance) record.energy_balance = std::move(part.energy_balance);
    there = there.with(h->outputs);
  }
  expect(there.cover(request.wanted), "only outputs that are held are read");
  return only(request.wanted, std::move(record));
}

void RunStore::keep(const RunRequest& request, RunRecord record) {
  const std::string text = run_text(request);
  if (record.lost) {
    const std::lock_guard guard(lock_);
    lost_[text] = std::move(record);
    return;
  }
  Held held{.outputs = request.wanted, .place = {}, .record = {}};
  if (file_)
    held.place = file_->append(payload_of(text, request.wanted, record));
  else
    held.record = std::move(record);
  const std::lock_guard guard(lock_);
  lost_.erase(text);
  held_[text].push_back(std::move(held));
}

std::vector<RunRequest> RunStore::requests() const {
  const std::lock_guard guard(lock_);
  std::vector<RunRequest> all;
  for (const auto& [text, frames] : held_) {
    RunRequest request = request_of(text);
    request.wanted = {.mean = false};
    for (const auto& h : frames) request.wanted = request.wanted.with(h.outputs);
    all.push_back(std::move(request));
  }
  return all;
}

std::size_t RunStore::size() const {
  const std::lock_guard guard(lock_);
  return held_.size();
}

std::size_t RunStore::lost() const {
  const std::lock_guard guard(lock_);
  return lost_.size();
}

bool RunStore::lost(const RunRequest& request) const {
  const std::lock_guard guard(lock_);
  return lost_.contains(run_text(request));
}

}  // namespace calomel
