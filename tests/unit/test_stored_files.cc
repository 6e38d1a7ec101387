// Stored contact problems: what is read, what is refused.
#include "app/solve_command.h"
#include "core/output_folder.h"
#include "nonsmooth/frictional_contact/fclib.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

namespace nsfd::test_stored_files
{
  namespace
  {
    namespace fs = std::filesystem;

    /** Two contacts in the plane; W is unsymmetric and not all of it stored. */
    ContactProblem two_contacts()
    {
      ContactProblem problem;
      problem.dimension = 2;
      problem.row_start = {0, 3, 5, 8, 9};
      problem.column = {0, 1, 2, 0, 1, 0, 2, 3, 3};
      problem.value = {2., 0.5, -0.25, 0.4, 3., 0.125, 2.5, 0.1, 4.};
      problem.q = {-1., 0.5, -2., 0.25};
      problem.friction = {0.3, 0.6};
      problem.guess = {0.1, 0.2, 0.3, 0.4};
      problem.solution = {0.5, -0.1, 0.7, 0.2};
      problem.title = "two contacts";
      problem.description = "made by hand";
      problem.math_info = "W unsymmetric";
      return problem;
    }

    /** A file of its own for each test, gone afterwards. */
    class StoredFile : public testing::Test
    {
    protected:
      StoredFile()
          : file_((fs::temp_directory_path() / (std::string("nsfd_stored_") +
                                                testing::UnitTest::GetInstance()
                                                    ->current_test_info()
                                                    ->name() +
                                                ".hdf5"))
                      .string())
      {
      }
      ~StoredFile() override { fs::remove(file_); }

      /** Replace a data set, or take it away if there are no @p values. */
      template <typename T>
      void replace(const std::string &path, const std::vector<T> &values) const
      {
        const hid_t file = H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        ASSERT_GE(file, 0);
        if (H5Lexists(file, path.c_str(), H5P_DEFAULT) > 0)
          H5Ldelete(file, path.c_str(), H5P_DEFAULT);
        if (!values.empty()) {
          const hid_t type =
              std::is_same_v<T, int> ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
          const hsize_t size = values.size();
          const hid_t space = H5Screate_simple(1, &size, nullptr);
          const hid_t set = H5Dcreate2(file, path.c_str(), type, space,
                                       H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
          H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
          H5Dclose(set);
          H5Sclose(space);
        }
        H5Fclose(file);
      }

      void refused(const std::string &reason) const
      {
        try {
          read_fclib(file_);
          ADD_FAILURE() << "read, but should be refused: " << reason;
        } catch (const BadContactFile &error) {
          const std::string text = error.what();
          EXPECT_NE(text.find(reason), std::string::npos) << text;
          EXPECT_EQ(text.find(file_), 0u) << text;
        }
      }

      std::string file_;
    };

    void expect_equal(const ContactProblem &a, const ContactProblem &b)
    {
      EXPECT_EQ(a.dimension, b.dimension);
      EXPECT_EQ(a.row_start, b.row_start);
      EXPECT_EQ(a.column, b.column);
      EXPECT_EQ(a.value, b.value);
      EXPECT_EQ(a.q, b.q);
      EXPECT_EQ(a.friction, b.friction);
      EXPECT_EQ(a.guess, b.guess);
      EXPECT_EQ(a.solution, b.solution);
      EXPECT_EQ(a.title, b.title);
      EXPECT_EQ(a.description, b.description);
      EXPECT_EQ(a.math_info, b.math_info);
    }

    struct Triplets {
      std::vector<int> row, column;
      std::vector<double> value;
    };

    Triplets triplets(const ContactProblem &problem)
    {
      Triplets w;
      for (std::size_t i = 0; i < problem.n_rows(); ++i)
        for (int k = problem.row_start[i]; k < problem.row_start[i + 1]; ++k) {
          w.row.push_back(int(i));
          w.column.push_back(problem.column[k]);
          w.value.push_back(problem.value[k]);
        }
      return w;
    }
  } // namespace

  TEST_F(StoredFile, RoundTripKeepsEveryBit)
  {
    const ContactProblem problem = two_contacts();
    write_fclib(file_, problem);
    expect_equal(read_fclib(file_), problem);
  }

  // sound files are read together, and one that is not spoils no other
  TEST_F(StoredFile, ManyAreReadAsEachAlone)
  {
    const ContactProblem problem = two_contacts();
    write_fclib(file_, problem);
    const std::string other = file_ + "_other.hdf5", bad = file_ + "_bad.hdf5";
    ContactProblem untitled = problem;
    untitled.title = "";
    write_fclib(other, untitled);
    std::ofstream(bad) << "no HDF5";
    for (const std::vector<std::string> &files :
         {std::vector<std::string>{file_, other},
          {file_, bad, other, "absent", file_},
          std::vector<std::string>(150, file_),
          {}}) {
      const std::vector<ReadProblem> all = read_fclib(files);
      ASSERT_EQ(all.size(), files.size());
      for (std::size_t i = 0; i < files.size(); ++i) {
        std::string error;
        ContactProblem alone;
        try {
          alone = read_fclib(files[i]);
        } catch (const BadContactFile &reason) {
          error = reason.what();
        }
        EXPECT_EQ(all[i].error, error);
        expect_equal(all[i].problem, alone);
      }
    }
    fs::remove(other);
    fs::remove(bad);
  }

  TEST_F(StoredFile, AnswersOfSolveHaveReactionsAndVelocities)
  {
    ContactProblem problem = two_contacts();
    problem.solution.clear();
    write_fclib(file_, problem);
    const fs::path folder = file_ + "_answers";
    SolveCommand command;
    command.files = {file_};
    command.folder = folder.string();
    command.tolerance = 1e-12;
    std::ostringstream out, err;
    ASSERT_EQ(run_solve(command, out, err), 0) << err.str();
    const std::string answer = (folder / fs::path(file_).filename()).string();
    const ContactProblem solved = read_fclib(answer);
    EXPECT_LE(natural_map_error(problem, solved.solution), 1e-12);

    std::vector<double> u, stored(problem.n_rows());
    relative_velocity(problem, solved.solution, u);
    const hid_t file = H5Fopen(answer.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t set = H5Dopen2(file, "/solution/u", H5P_DEFAULT);
    EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                      stored.data()),
              0);
    H5Dclose(set);
    H5Fclose(file);
    EXPECT_EQ(stored, u);

    problem.solution = solved.solution; // all else is the problem
    expect_equal(solved, problem);
    EXPECT_EQ(run_solve(command, out, err), 1); // a file is in the way
    fs::remove_all(folder);
  }

  TEST_F(StoredFile, TextsGuessAndSolutionMayBeMissing)
  {
    ContactProblem problem = two_contacts();
    problem.guess.clear();
    problem.solution.clear();
    write_fclib(file_, problem);
    replace<int>("/fclib_local/info", {});
    problem.title = problem.description = problem.math_info = "";
    expect_equal(read_fclib(file_), problem);
  }

  TEST_F(StoredFile, ColumnsAreRowsOfTheTranspose)
  {
    const ContactProblem problem = two_contacts();
    write_fclib(file_, problem);
    replace<int>("/fclib_local/W/nz", {-1});
    // W by columns, written down by hand
    replace<int>("/fclib_local/W/p", {0, 3, 5, 7, 9});
    replace<int>("/fclib_local/W/i", {0, 1, 2, 0, 1, 0, 2, 2, 3});
    replace<double>("/fclib_local/W/x",
                    {2., 0.4, 0.125, 0.5, 3., -0.25, 2.5, 0.1, 4.});
    expect_equal(read_fclib(file_), problem);
  }

  TEST_F(StoredFile, TripletsAreAddedInAnyOrder)
  {
    const ContactProblem problem = two_contacts();
    write_fclib(file_, problem);
    Triplets w = triplets(problem);
    std::reverse(w.row.begin(), w.row.end());
    std::reverse(w.column.begin(), w.column.end());
    std::reverse(w.value.begin(), w.value.end());
    // the last one in two halves, exact in binary
    w.row.push_back(w.row[0]);
    w.column.push_back(w.column[0]);
    w.value[0] *= 0.5;
    w.value.push_back(w.value[0]);
    replace<int>("/fclib_local/W/nz", {int(w.value.size())});
    replace("/fclib_local/W/i", w.row);
    replace("/fclib_local/W/p", w.column);
    replace("/fclib_local/W/x", w.value);
    replace<int>("/solution", {});
    ContactProblem expected = problem;
    expected.solution.clear();
    expect_equal(read_fclib(file_), expected);
  }

  // whichever index is the row: the stored solution is one of that problem
  TEST_F(StoredFile, TheSolutionTellsRowsFromColumns)
  {
    ContactProblem problem = two_contacts();
    problem.friction = {0., 0.};
    // frictionless and closed: 2 x - 0.25 y = 1, 0.125 x + 2.5 y = 2
    const double det = 2. * 2.5 + 0.25 * 0.125;
    problem.solution = {(2.5 + 0.5) / det, 0., (4. - 0.125) / det, 0.};
    ASSERT_LT(natural_map_error(problem, problem.solution), 1e-15);
    write_fclib(file_, problem);
    const Triplets w = triplets(problem);
    replace<int>("/fclib_local/W/nz", {int(w.value.size())});
    replace("/fclib_local/W/x", w.value);
    for (const bool swapped : {false, true}) {
      replace("/fclib_local/W/i", swapped ? w.column : w.row);
      replace("/fclib_local/W/p", swapped ? w.row : w.column);
      expect_equal(read_fclib(file_), problem);
    }
  }

  TEST_F(StoredFile, ForeignAndBrokenFilesAreRefused)
  {
    EXPECT_THROW(read_fclib("/no/such/file.hdf5"), BadContactFile);
    refused("there is no such file");
    std::ofstream(file_) << "no HDF5 at all";
    refused("not an HDF5 file");
    std::ofstream(file_).close();
    refused("not an HDF5 file");

    write_fclib(file_, two_contacts());
    const auto size = fs::file_size(file_);
    for (const double part : {0.9, 0.5, 0.1}) {
      fs::resize_file(file_, std::uintmax_t(part * double(size)));
      EXPECT_THROW(read_fclib(file_), BadContactFile) << part;
    }

    write_fclib(file_, two_contacts());
    replace<int>("/fclib_local", {});
    refused("no group /fclib_local");
  }

  // HDF5 1.10 follows some of these addresses, out of its own memory.
  TEST_F(StoredFile, NoAddressCrashesTheReader)
  {
    write_fclib(file_, two_contacts());
    unsigned int refused = 0;
    for (std::streamoff at = 0; at < 2048; at += 8) {
      std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
      std::string word(8, '\0'), ones(8, '\xff');
      file.seekg(at).read(word.data(), 8);
      if (word == std::string(8, '\0') || word == ones)
        continue;
      file.seekp(at).write(ones.data(), 8).flush();
      try {
        read_fclib(file_);
      } catch (const BadContactFile &) {
        ++refused;
      }
      file.seekp(at).write(word.data(), 8).flush();
    }
    EXPECT_GT(refused, 10u);
    expect_equal(read_fclib(file_), two_contacts());
  }

  TEST_F(StoredFile, WrongContentsAreRefusedWithThePlace)
  {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    struct Case {
      std::string reason;
      std::function<void()> spoil;
    };
    const std::string w = "/fclib_local/W/", v = "/fclib_local/vectors/";
    const std::vector<Case> cases = {
        {"no data set /fclib_local/W/x", [&] { replace<double>(w + "x", {}); }},
        {"no data set /fclib_local/vectors/mu",
         [&] { replace<double>(v + "mu", {}); }},
        {"spacedim is 4", [&] { replace<int>("/fclib_local/spacedim", {4}); }},
        {"spacedim has 2 values",
         [&] {
           replace<int>("/fclib_local/spacedim", {2, 2});
         }},
        {"q has 4 values and mu 3",
         [&] {
           replace<double>(v + "mu", {0., 0., 0.});
         }},
        {"W is 4 x 6", [&] { replace<int>(w + "n", {6}); }},
        {"nz is -3", [&] { replace<int>(w + "nz", {-3}); }},
        {"W has 20 triplets", [&] { replace<int>(w + "nz", {20}); }},
        {"W/p must be 5 pointers",
         [&] {
           replace<int>(w + "p", {0, 3, 5, 9});
         }},
        {"W/p must be 5 pointers",
         [&] {
           replace<int>(w + "p", {0, 5, 3, 8, 9});
         }},
        {"at most 9",
         [&] {
           replace<int>(w + "p", {0, 3, 5, 8, 10});
         }},
        {"at index 4",
         [&] {
           replace<int>(w + "i", {0, 1, 2, 0, 1, 0, 2, 3, 4});
         }},
        {"at index -1",
         [&] {
           replace<int>(w + "i", {-1, 1, 2, 0, 1, 0, 2, 3, 3});
         }},
        {"friction coefficient is -0.1",
         [&] {
           replace<double>(v + "mu", {0.3, -0.1});
         }},
        {"no finite number",
         [&] {
           replace<double>(v + "q", {0., 0., nan, 0.});
         }},
        {"/solution/r has 3 values",
         [&] {
           replace<double>("/solution/r", {0., 0., 0.});
         }},
        {"equality constraints", [&] { replace<int>("/fclib_local/V", {1}); }}};
    for (const Case &c : cases) {
      write_fclib(file_, two_contacts());
      c.spoil();
      refused(c.reason);
    }
    EXPECT_THROW(write_fclib("/no/such/folder/a.hdf5", two_contacts()),
                 OutputError);
  }
} // namespace nsfd::test_stored_files
