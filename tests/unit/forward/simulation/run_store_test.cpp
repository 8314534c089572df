// The store of runs: what is kept, what a record serves, and journals of the first version.
#include "forward/simulation/run_store.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "base/provenance.hpp"
#include "tests/scratch.hpp"

namespace calomel {
namespace {

const Provenance of_test{.stage = "runs", .seed = 3};

RunRequest run_at(double a, Outputs wanted = {}) {
  RunRequest r;
  r.numbers = {{"number.a", a}};
  r.wanted = wanted;
  return r;
}

RunRecord of_mean(float value) { return {.done = true, .mean = {value}}; }

TEST(RunRecord, ComesBackFromItsBytes) {
  RunRecord r{.done = true, .message = "", .mean = {1, 2, 3}, .energy_slope = {4, 5, 6}, .scatter = {}, .pulses = {1, 2, 3, 4, 5, 6}, .energies = {0.99, 1.01}};
  EXPECT_EQ(record_of(bytes_of(r)), r);
  r = {.message = "step 3, element 7"};
  EXPECT_EQ(record_of(bytes_of(r)), r);
  EXPECT_THROW((void)record_of(bytes_of(r).substr(0, 12)), ContractFailure);
  // A record without what few records have keeps the bytes of the first version: nothing behind the energies.
  const RunRecord plain{.done = true, .message = "", .mean = {1, 2, 3}, .energies = {0.99}};
  RunRecord totalled = plain;
  totalled.totals = {0.25, 1e-5};
  EXPECT_EQ(bytes_of(plain).size(), 1 + 6 * sizeof(std::uint64_t) + 3 * sizeof(float) + sizeof(double));
  EXPECT_EQ(bytes_of(totalled).substr(0, bytes_of(plain).size()), bytes_of(plain));
  EXPECT_EQ(record_of(bytes_of(totalled)), totalled);
  RunRecord exact = plain;
  exact.exact = {1.0 / 3, -1e300, 2};
  EXPECT_EQ(record_of(bytes_of(exact)), exact);
  r.mean = {0.1f, 1e30f};
  EXPECT_EQ(r.history(), Eigen::Vector2d(double(0.1f), double(1e30f)));
  EXPECT_EQ(exact.history(), Eigen::Vector3d(1.0 / 3, -1e300, 2));
}

TEST(RunStore, KeepsARunInThisLifeAndTheNext) {
  const auto path = scratch("run_store") / "runs.journal";
  {
    RunStore store(of_test, path);
    EXPECT_FALSE(store.holds(run_at(1)));
    EXPECT_THROW((void)store.read(run_at(1)), ContractFailure);
    store.keep(run_at(1), of_mean(10));
    store.keep(run_at(2), {.message = "a is even"});
    EXPECT_TRUE(store.holds(run_at(1)));
  }
  RunStore store(of_test, path);
  EXPECT_EQ(store.size(), 2u);
  EXPECT_EQ(store.read(run_at(1)), of_mean(10));
  EXPECT_FALSE(store.read(run_at(2)).done);
  EXPECT_EQ(store.read(run_at(2)).message, "a is even");
  EXPECT_THAT(store.requests(), testing::ElementsAre(run_at(1), run_at(2)));  // in the order of the texts
}

TEST(RunStore, ARecordServesEveryRequestThatItCovers) {
  for (const bool in_memory : {true, false}) {
    const auto path = scratch("run_store_covers") / "runs.journal";
    std::optional<RunStore> store;
    if (in_memory)
      store.emplace();
    else
      store.emplace(of_test, path);
    const Outputs pulses{.mean = true, .pulses = true}, totals{.mean = false, .totals = true};
    RunRecord with_pulses = of_mean(10);
    with_pulses.pulses = {9, 11};
    with_pulses.energies = {0.9, 1.1};
    store->keep(run_at(1, pulses), with_pulses);
    EXPECT_TRUE(store->holds(run_at(1)));
    EXPECT_EQ(store->read(run_at(1)), of_mean(10)) << "a record has what was requested and no more";
    EXPECT_EQ(store->read(run_at(1, pulses)), with_pulses);
    EXPECT_FALSE(store->holds(run_at(1, totals)));
    store->keep(run_at(1, totals), {.done = true, .totals = {0.5, 1e-6}});
    EXPECT_EQ(store->read(run_at(1, totals)), (RunRecord{.done = true, .totals = {0.5, 1e-6}}));
    RunRecord all = with_pulses;
    all.totals = {0.5, 1e-6};
    EXPECT_EQ(store->read(run_at(1, pulses.with(totals))), all);
    EXPECT_EQ(store->size(), 1u);
    EXPECT_EQ(store->requests().at(0).wanted, pulses.with(totals));
    store->keep(run_at(2, totals), {.message = "no balance"});
    store->keep(run_at(2), of_mean(1));
    EXPECT_TRUE(store->read(run_at(2)).done);
    RunRequest both = run_at(2, totals.with({}));
    EXPECT_FALSE(store->read(both).done);
    EXPECT_EQ(store->read(both).message, "no balance");
  }
}

TEST(RunStore, AMissingResponseIsNotKept) {
  const auto path = scratch("run_store_lost") / "runs.journal";
  {
    RunStore store(of_test, path);
    store.keep(run_at(1), {.lost = true, .message = "no answer"});
    EXPECT_TRUE(store.lost(run_at(1)));
    EXPECT_FALSE(store.holds(run_at(1)));
    EXPECT_EQ(store.read(run_at(1)).message, "no answer");
    EXPECT_EQ(store.lost(), 1u);
    store.keep(run_at(1), of_mean(1));
    EXPECT_EQ(store.lost(), 0u);
  }
  EXPECT_EQ(RunStore(of_test, path).size(), 1u);
}

TEST(RunStore, CutOffInAWriteKeepsEveryRecordThatIsWhole) {
  const auto path = scratch("run_store_cut") / "runs.journal";
  {
    RunStore store(of_test, path);
    store.keep(run_at(1), of_mean(1));
    store.keep(run_at(2), of_mean(2));
  }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 3);
  const RunStore store(of_test, path);
  EXPECT_EQ(store.size(), 1u);
  EXPECT_TRUE(store.holds(run_at(1)));
}

TEST(RunStore, RefusesAJournalOfAnotherCase) {
  const auto path = scratch("run_store_other") / "runs.journal";
  { RunStore store(of_test, path); }
  EXPECT_EQ(RunStore::identity(path), of_test.identity());
  EXPECT_THROW(RunStore(Provenance{.stage = "runs", .options = {{"time", {{"end", 1}}}}, .seed = 3}, path), InputError);
}

/// A journal as program 0.1.0 wrote it: the point's text, then the record.
void write_first_version(const std::filesystem::path& path, const std::vector<std::pair<std::string, RunRecord>>& runs) {
  FrameFile file(path, "calomel runs 1", of_test, [](std::string_view, FrameFile::Place) {});
  for (const auto& [text, record] : runs) {
    ByteWriter payload;
    payload.text(text);
    payload.bytes += bytes_of(record);
    (void)file.append(payload.bytes);
  }
}

TEST(RunStore, ReadsJournalsOfTheFirstVersion) {
  const auto path = scratch("run_store_first") / "runs.journal";
  RunRecord with_pulses = of_mean(10);
  with_pulses.pulses = {9, 11};
  with_pulses.energies = {0.9, 1.1};
  write_first_version(path, {{"campaign.keep_pulses=1 number.a=1", with_pulses},
                             {"number.a=1 solver.energy_balance=1", {.done = true, .totals = {0.5, 1e-6}}},
                             {"number.a=2", {.message = "a is even"}},
                             {"geometry.element_size=0.001 material.mercury.regularising_viscosity=2000 number.a=3", of_mean(3)}});
  EXPECT_EQ(RunStore::identity(path), of_test.identity());
  for (int life = 0; life < 2; ++life) {  // rewritten in the first
    RunStore store(of_test, path);
    EXPECT_EQ(store.size(), 3u);
    EXPECT_EQ(store.read(run_at(1)), of_mean(10));
    EXPECT_EQ(store.read(run_at(1, {.mean = true, .pulses = true, .totals = true})).totals.size(), 2u);
    EXPECT_EQ(store.read(run_at(2)).message, "a is even");
    RunRequest on_mesh = run_at(3);
    on_mesh.element_size = 0.001;
    on_mesh.numbers["material.mercury.regularising_viscosity"] = 2000;
    EXPECT_EQ(store.read(on_mesh), of_mean(3));
    EXPECT_EQ(RunStore::identity(path), of_test.identity());
  }
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".rewritten"));
}

TEST(RunStore, AJournalOfTheFirstVersionOfAnotherCaseIsNotChanged) {
  const auto path = scratch("run_store_first_other") / "runs.journal";
  write_first_version(path, {{"number.a=1", of_mean(10)}});
  const auto before = std::filesystem::file_size(path);
  EXPECT_THROW(RunStore(Provenance{.stage = "runs", .options = {{"time", {{"end", 1}}}}, .seed = 3}, path), InputError);
  EXPECT_EQ(std::filesystem::file_size(path), before);
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".rewritten"));
  EXPECT_TRUE(RunStore(of_test, path).holds(run_at(1)));
}

}  // namespace
}  // namespace calomel
