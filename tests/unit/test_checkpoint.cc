#include "checkpoint/checkpoint_file.h"
#include "checkpoint/hdf5_image.h"
#include "checkpoint/parameter_changes.h"
#include "checkpoint/rank_order.h"
#include "postprocess/history_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>

namespace test_checkpoint
{
  using namespace nsfd;
  namespace fs = std::filesystem;

  class Folder
  {
  public:
    Folder()
        : path_(fs::temp_directory_path() /
                ("nsfd_checkpoint_" + std::to_string(getpid())))
    {
      fs::remove_all(path_);
      fs::create_directories(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    const fs::path &path() const { return path_; }

  private:
    const fs::path path_;
  };

  std::vector<char> sealed(const double value)
  {
    Hdf5Image image(checkpoint_file::head_size);
    image.write("a/b", std::vector<double>{value, 2., 3., 4.}, 2);
    image.write("a/text", std::string("line\nline"));
    auto bytes = image.bytes();
    checkpoint_file::seal(bytes);
    return bytes;
  }

  TEST(Checkpoint, HoldsTheBitsOfItsNumbers)
  {
    const double third = 1. / 3.;
    auto bytes = sealed(third);
    EXPECT_EQ(checkpoint_file::problem_of(bytes), "");
    const Hdf5Image image(bytes);
    std::vector<double> values;
    unsigned int components = 0;
    ASSERT_TRUE(image.read("a/b", values, components));
    EXPECT_EQ(components, 2u);
    EXPECT_EQ(values, (std::vector<double>{third, 2., 3., 4.}));
    std::string text;
    ASSERT_TRUE(image.read("a/text", text));
    EXPECT_EQ(text, "line\nline");
    EXPECT_FALSE(image.read("a/c", values, components));
  }

  // Every byte and every length counts, the head included.
  TEST(Checkpoint, SeesEveryChange)
  {
    const auto bytes = sealed(1.);
    for (std::size_t i = 0; i < bytes.size(); i += i < 80 ? 1 : 97) {
      auto damaged = bytes;
      damaged[i] = char(damaged[i] ^ 4);
      // the name of the program, and what follows the lines, are no data
      const std::string head(bytes.begin(), bytes.begin() + 200);
      const auto program = head.find("program"), length = head.find("bytes");
      if ((i >= program && i < length) || (i >= head.find('\0') && i < 512))
        continue;
      EXPECT_NE(checkpoint_file::problem_of(damaged), "") << "byte " << i;
    }
    for (const std::size_t n : {0, 1, 100, 511, 512, 1000}) {
      const std::vector<char> part(bytes.begin(), bytes.begin() + long(n));
      EXPECT_NE(checkpoint_file::problem_of(part), "") << n << " bytes";
    }
    auto longer = bytes;
    longer.push_back(0);
    EXPECT_NE(checkpoint_file::problem_of(longer), "");
  }

  TEST(Checkpoint, KeepsTheOneBefore)
  {
    const Folder folder;
    const auto places = checkpoint_file::candidates(folder.path());
    const auto first = sealed(1.), second = sealed(2.), third = sealed(3.);
    checkpoint_file::put(folder.path(), first);
    EXPECT_FALSE(fs::exists(places[1]));
    checkpoint_file::put(folder.path(), second);
    checkpoint_file::put(folder.path(), third);
    EXPECT_TRUE(checkpoint_file::read(places[0]) == third);
    EXPECT_TRUE(checkpoint_file::read(places[1]) == second);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);
  }

  TEST(Checkpoint, FailsWithoutChangingAnything)
  {
    EXPECT_THROW(checkpoint_file::put("/nowhere", sealed(1.)),
                 std::runtime_error);
    const Folder folder;
    const auto first = sealed(1.); // HDF5 writes the second of its making
    checkpoint_file::put(folder.path(), first);
    // in its way, with something in it
    fs::create_directories(folder.path() / "checkpoint.h5.part" / "kept");
    EXPECT_THROW(checkpoint_file::put(folder.path(), sealed(2.)),
                 std::runtime_error);
    EXPECT_TRUE(checkpoint_file::read(folder.path() / "checkpoint.h5") ==
                first);
  }

  TEST(Checkpoint, NamesChangedParameters)
  {
    const std::string then = "# title\nset dimension = 2 # 2 or 3\n"
                             "subsection Time\n  set end  = 10 ns # s\n"
                             "  set step = 1 ns\n  # set other =\nend\n"
                             "subsection Material: bulk\n  set density = 1\n"
                             "end\n",
                      now = "set dimension = 2\nsubsection Time\n"
                            "  set end = 20 ns\n  set step=1 ns # s\n"
                            "  set sliding = velocity\nend\n"
                            "subsection Material: bulk\nend\n";
    const auto changes = parameter_changes(then, now);
    ASSERT_EQ(changes.size(), 3u);
    EXPECT_EQ(changes[0].text(), "Time/end: 10 ns, now 20 ns");
    EXPECT_TRUE(changes[0].allowed());
    EXPECT_EQ(changes[1].text(), "Time/sliding: not set, now velocity");
    EXPECT_FALSE(changes[1].allowed());
    EXPECT_EQ(changes[2].text(), "Material: bulk/density: 1, now not set");
    EXPECT_FALSE(changes[2].allowed());
    EXPECT_TRUE(parameter_changes(now, now).empty());
  }

  // What history.csv holds is all of a row, to the last bit.
  TEST(Checkpoint, ReadsItsHistoryBack)
  {
    const Folder folder;
    const std::string path = folder.path() / "history.csv";
    std::uintmax_t n_bytes = 0;
    std::vector<HistoryRow> rows(3);
    {
      HistoryFile file(path, {{"left, or right"}, 2});
      for (unsigned int k = 0; k < rows.size(); ++k) {
        HistoryRow &row = rows[k];
        row.step = k + 1;
        row.time = 0.1 * (k + 1) / 3.;
        row.energy.damage = std::nextafter(1., 2.) * k;
        row.energy.work = -1e-300;
        row.residual = 1e-9 / 7.;
        row.fragments = 4;
        row.reactions = {1. / 7., -2.};
        file.write(row);
        if (k == 1)
          n_bytes = file.n_bytes();
      }
    }
    const HistoryFile::Columns columns = {{"left, or right"}, 2},
                               others = {{"left", "right"}, 2};
    const auto read = HistoryFile::read(path, columns, n_bytes);
    ASSERT_EQ(read.size(), 2u);
    for (unsigned int k = 0; k < 2; ++k) {
      EXPECT_EQ(read[k].step, rows[k].step);
      EXPECT_EQ(read[k].time, rows[k].time);
      EXPECT_EQ(read[k].energy.damage, rows[k].energy.damage);
      EXPECT_EQ(read[k].energy.work, rows[k].energy.work);
      EXPECT_EQ(read[k].residual, rows[k].residual);
      EXPECT_EQ(read[k].fragments, rows[k].fragments);
      EXPECT_EQ(read[k].reactions, rows[k].reactions);
    }
    EXPECT_THROW(HistoryFile::read(path, columns, 10000), std::runtime_error);
    EXPECT_THROW(HistoryFile::read(path, others, n_bytes), std::runtime_error);
    const auto whole = fs::file_size(path);
    HistoryFile cut(path, columns, n_bytes);
    EXPECT_EQ(fs::file_size(path), n_bytes);
    cut.write(rows[2]);
    EXPECT_EQ(fs::file_size(path), whole);
  }

  // Items in any order, on any number of ranks: to the order of keys and back.
  TEST(Checkpoint, OrdersByKeys)
  {
    const Communicator communicator(MPI_COMM_WORLD);
    const unsigned int n = 20, rank = unsigned(communicator.rank());
    // every rank owns items of its own, and sees all of those of rank 0
    std::vector<RankOrder::Key> keys;
    for (unsigned int i = 0; i < n; ++i)
      keys.push_back({{1000 * rank + (7 * i) % n, 0, 3}});
    for (unsigned int i = 0; rank > 0 && i < n; ++i)
      keys.push_back({{i, 0, 3}});
    const RankOrder order(communicator, keys, n);
    EXPECT_EQ(order.n_global(), std::size_t(n * communicator.size()));
    std::vector<double> values;
    for (const auto &key : keys)
      values.insert(values.end(), {double(key[0]), -double(key[0])});
    const auto all = order.gather(values, 2);
    if (communicator.is_root()) {
      ASSERT_EQ(all.size(), 2 * order.n_global());
      for (std::size_t i = 1; i < order.n_global(); ++i)
        EXPECT_LT(all[2 * i - 2], all[2 * i]);
    }
    EXPECT_EQ(order.scatter(all, 2), values);
  }
} // namespace test_checkpoint
