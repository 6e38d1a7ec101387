#include "core/hdf5_file.h"
#include "core/trial_process.h"
#include "fclib.h"

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <numeric>
#include <sstream>

namespace boost::serialization
{
  template <typename Archive>
  void serialize(Archive &archive, nsfd::ReadProblem &answer, unsigned int)
  {
    nsfd::ContactProblem &p = answer.problem;
    archive &p.dimension &p.row_start &p.column &p.value &p.q &p.friction;
    archive &p.guess &p.solution &p.title &p.description &p.math_info;
    archive &answer.error;
  }
} // namespace boost::serialization

namespace nsfd
{
  namespace
  {
    using stored::Handle;

    /** Reads data sets of one file; whatever is wrong names file and path. */
    class Reader
    {
    public:
      explicit Reader(const std::string &name)
          : name_(name), n_bytes_(double(std::filesystem::file_size(name))),
            file_(open(name), H5Fclose)
      {
        if (!file_)
          fail("it is not an HDF5 file, or not a whole one");
      }

      [[noreturn]] void fail(const std::string &message) const
      {
        throw BadContactFile(fmt::format("{}: {}", name_, message));
      }

      /** Every group on the way, and the data set itself. */
      bool has(const std::string &path) const
      {
        for (std::size_t end = path.find('/', 1);;
             end = path.find('/', end + 1)) {
          if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0)
            return false;
          if (end == std::string::npos)
            return true;
        }
      }

      std::vector<double> numbers(const std::string &path) const
      {
        return values<double>(path, H5T_NATIVE_DOUBLE);
      }
      std::vector<int> integers(const std::string &path) const
      {
        return values<int>(path, H5T_NATIVE_INT);
      }
      int integer(const std::string &path) const
      {
        const std::vector<int> all = integers(path);
        if (all.size() != 1)
          fail(
              fmt::format("{} has {} values; one is needed", path, all.size()));
        return all[0];
      }

      /** A text of fixed or variable length; empty if there is none. */
      std::string text(const std::string &path) const
      {
        if (!has(path))
          return "";
        const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
        const Handle type(set ? H5Dget_type(set) : -1, H5Tclose);
        if (!type || H5Tget_class(type) != H5T_STRING ||
            H5Tis_variable_str(type) > 0)
          return "";
        constexpr std::size_t longest = 1u << 20;
        const std::size_t size = H5Tget_size(type);
        const Handle space(H5Dget_space(set), H5Sclose);
        if (size > longest || !space ||
            H5Sget_simple_extent_npoints(space) != 1)
          return "";
        std::string result(size, '\0');
        if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &result[0]) < 0)
          return "";
        return result.substr(0, result.find('\0'));
      }

    private:
      static hid_t open(const std::string &name)
      {
        return H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
      }

      template <typename T>
      std::vector<T> values(const std::string &path, const hid_t type) const
      {
        if (!has(path))
          fail(fmt::format("there is no data set {}: a problem in the layout "
                           "of FCLIB has one",
                           path));
        const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
        const Handle space(set ? H5Dget_space(set) : -1, H5Sclose);
        const hssize_t size = space ? H5Sget_simple_extent_npoints(space) : -1;
        if (size < 0)
          fail(fmt::format("{} is not a data set", path));
        // what is not stored can have any size; compressed, a byte holds some
        // thousand zeros at most
        constexpr double most_per_byte = 1100.;
        if (double(size) * sizeof(T) > most_per_byte * n_bytes_ ||
            size > std::numeric_limits<int>::max())
          fail(fmt::format("{} has {} values, which the file cannot hold", path,
                           size));
        std::vector<T> result(size);
        if (size > 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                result.data()) < 0)
          fail(fmt::format("{} cannot be read: the file may be cut short",
                           path));
        return result;
      }

      std::string name_;
      double n_bytes_;
      Handle file_;
    };

    struct Triplets {
      std::vector<int> row, column;
      std::vector<double> value;
    };

    /** Compressed pointers to one index per entry. */
    std::vector<int> expand(const Reader &reader, const std::vector<int> &start,
                            const int rows, const std::size_t entries)
    {
      if (start.size() != std::size_t(rows) + 1 || start[0] != 0 ||
          !std::is_sorted(start.begin(), start.end()) ||
          std::size_t(start.back()) > entries)
        reader.fail(
            fmt::format("/fclib_local/W/p must be {} pointers that grow from 0 "
                        "to at most {}",
                        rows + 1, entries));
      std::vector<int> index(start.back());
      for (int i = 0; i < rows; ++i)
        std::fill(index.begin() + start[i], index.begin() + start[i + 1], i);
      return index;
    }

    Triplets read_matrix(const Reader &reader, const int size)
    {
      const std::string group = "/fclib_local/W/";
      for (const char *name : {"m", "n"})
        if (reader.integer(group + name) != size)
          reader.fail(fmt::format("W is {} x {}; with {} components of q it "
                                  "must be {} x {}",
                                  reader.integer(group + "m"),
                                  reader.integer(group + "n"), size, size,
                                  size));
      const int kind = reader.integer(group + "nz");
      std::vector<int> p = reader.integers(group + "p");
      std::vector<int> i = reader.integers(group + "i");
      Triplets w;
      w.value = reader.numbers(group + "x");
      if (kind < -2)
        reader.fail(fmt::format("{}nz is {}; -2 (rows), -1 (columns) or a "
                                "number of triplets is known",
                                group, kind));
      if (kind >= 0) {
        const std::size_t n = kind;
        if (i.size() < n || p.size() < n || w.value.size() < n)
          reader.fail(
              fmt::format("W has {} triplets, but only {} values", n,
                          std::min({i.size(), p.size(), w.value.size()})));
        i.resize(n);
        p.resize(n);
        w.value.resize(n);
        w.row = std::move(i);
        w.column = std::move(p);
      } else {
        const std::vector<int> outer =
            expand(reader, p, size, std::min(i.size(), w.value.size()));
        i.resize(outer.size());
        w.value.resize(outer.size());
        w.row = kind == -2 ? outer : i;
        w.column = kind == -2 ? std::move(i) : outer;
      }
      for (const std::vector<int> *index : {&w.row, &w.column})
        for (const int k : *index)
          if (k < 0 || k >= size)
            reader.fail(fmt::format("W has an entry at index {}; indices are "
                                    "0 to {}",
                                    k, size - 1));
      return w;
    }

    /** Sorted rows; entries at the same place are added. */
    void set_rows(const Triplets &w, ContactProblem &problem)
    {
      const std::size_t n = problem.n_rows();
      std::vector<std::size_t> order(w.value.size());
      std::iota(order.begin(), order.end(), 0);
      std::stable_sort(order.begin(), order.end(),
                       [&](const std::size_t a, const std::size_t b) {
                         return w.row[a] != w.row[b]
                                    ? w.row[a] < w.row[b]
                                    : w.column[a] < w.column[b];
                       });
      problem.row_start.assign(n + 1, 0);
      problem.column.clear();
      problem.value.clear();
      int row = -1;
      for (const std::size_t k : order) {
        if (w.row[k] == row && w.column[k] == problem.column.back()) {
          problem.value.back() += w.value[k];
          continue;
        }
        row = w.row[k];
        problem.column.push_back(w.column[k]);
        problem.value.push_back(w.value[k]);
        ++problem.row_start[row + 1];
      }
      std::partial_sum(problem.row_start.begin(), problem.row_start.end(),
                       problem.row_start.begin());
    }

    /** A vector of impulses, if the file has one of the right length. */
    std::vector<double> read_impulse(const Reader &reader,
                                     const std::string &path,
                                     const std::size_t size)
    {
      if (!reader.has(path))
        return {};
      std::vector<double> r = reader.numbers(path);
      if (r.size() != size)
        reader.fail(fmt::format("{} has {} values; W has {} rows", path,
                                r.size(), size));
      return r;
    }

    void check(const Reader &reader, const ContactProblem &problem)
    {
      for (const double mu : problem.friction)
        if (!(mu >= 0.) || !std::isfinite(mu))
          reader.fail(fmt::format("a friction coefficient is {}; write "
                                  "numbers from 0",
                                  mu));
      for (const std::vector<double> *values : {&problem.q, &problem.value})
        for (const double value : *values)
          if (!std::isfinite(value))
            reader.fail("W or q has an entry that is no finite number");
    }

    ContactProblem read_here(const std::string &file)
    {
      const stored::QuietHdf5 quiet;
      const Reader reader(file);
      if (!reader.has("/fclib_local"))
        reader.fail(
            reader.has("/fclib_global")
                ? "it holds a problem with bodies (fclib_global); write "
                  "the condensed one (fclib_local)"
                : "there is no group /fclib_local: it holds no contact "
                  "problem in the layout of FCLIB");
      if (reader.has("/fclib_local/V") || reader.has("/fclib_local/R"))
        reader.fail("it has equality constraints (V, R); eliminate them first");

      ContactProblem problem;
      const int dimension = reader.integer("/fclib_local/spacedim");
      if (dimension != 2 && dimension != 3)
        reader.fail(
            fmt::format("spacedim is {}; 2 or 3 is possible", dimension));
      problem.dimension = dimension;
      problem.q = reader.numbers("/fclib_local/vectors/q");
      problem.friction = reader.numbers("/fclib_local/vectors/mu");
      if (problem.q.size() != problem.friction.size() * problem.dimension)
        reader.fail(
            fmt::format("q has {} values and mu {}; with spacedim = {} q "
                        "must have {}",
                        problem.q.size(), problem.friction.size(), dimension,
                        problem.friction.size() * dimension));
      Triplets w = read_matrix(reader, problem.q.size());
      set_rows(w, problem);
      check(reader, problem);
      problem.solution = read_impulse(reader, "/solution/r", problem.q.size());
      problem.guess = read_impulse(reader, "/guesses/1/r", problem.q.size());
      problem.title = reader.text("/fclib_local/info/title");
      problem.description = reader.text("/fclib_local/info/description");
      problem.math_info = reader.text("/fclib_local/info/math_info");

      if (reader.integer("/fclib_local/W/nz") >= 0 &&
          !problem.solution.empty()) {
        const double error = natural_map_error(problem, problem.solution);
        ContactProblem other = problem;
        std::swap(w.row, w.column);
        set_rows(w, other);
        if (natural_map_error(other, other.solution) < error)
          return other;
      }
      return problem;
    }

    std::string answer_for(const std::vector<std::string> &files)
    {
      std::vector<ReadProblem> answers(files.size());
      for (std::size_t i = 0; i < files.size(); ++i)
        try {
          answers[i].problem = read_here(files[i]);
        } catch (const BadContactFile &error) {
          answers[i].error = error.what();
        }
      std::ostringstream out;
      boost::archive::binary_oarchive(out, boost::archive::no_header)
          << answers;
      return out.str();
    }

    /** Of a copy that may have lost its mind on the way. */
    bool is_sound(const ContactProblem &problem)
    {
      const std::size_t n = problem.n_rows();
      const auto fits = [&](const std::vector<double> &r) {
        return r.empty() || r.size() == n;
      };
      if ((problem.dimension != 2 && problem.dimension != 3) ||
          n != problem.n_contacts() * problem.dimension ||
          problem.row_start.size() != n + 1 || problem.row_start.front() != 0 ||
          !std::is_sorted(problem.row_start.begin(), problem.row_start.end()) ||
          std::size_t(problem.row_start.back()) != problem.value.size() ||
          problem.column.size() != problem.value.size() ||
          !fits(problem.guess) || !fits(problem.solution))
        return false;
      return std::all_of(problem.column.begin(), problem.column.end(),
                         [&](const int column) {
                           return column >= 0 && std::size_t(column) < n;
                         });
    }

    std::string damaged(const std::string &file, const std::string &reason)
    {
      return fmt::format("{}: the file is damaged: HDF5 cannot read it ({})",
                         file, reason);
    }

    /** In one copy of the process: HDF5 follows the addresses in a file
     * wherever they lead. @return nothing, with @p end, if the copy was lost */
    std::vector<ReadProblem>
    read_in_a_copy(const std::vector<std::string> &files, const double bytes,
                   std::string &end)
    {
      constexpr double gib = 0x1p30, bytes_per_second = 1e6;
      const CopyAnswer copy =
          ask_a_copy([&] { return answer_for(files); },
                     {20. + bytes / bytes_per_second, 4. * gib + 20. * bytes});
      std::vector<ReadProblem> answers;
      end = copy.end;
      if (!end.empty())
        return answers;
      end = "its numbers are lost";
      try {
        std::istringstream in(copy.bytes);
        boost::archive::binary_iarchive(in, boost::archive::no_header) >>
            answers;
      } catch (const std::exception &) {
        return {};
      }
      for (const ReadProblem &answer : answers)
        if (answer.error.empty() && !is_sound(answer.problem))
          return {};
      if (answers.size() != files.size())
        return {};
      end.clear();
      return answers;
    }

    ReadProblem read_alone(const std::string &file)
    {
      if (!std::filesystem::is_regular_file(file))
        return {{}, fmt::format("{}: there is no such file", file)};
      std::string end;
      std::vector<ReadProblem> answers =
          read_in_a_copy({file}, double(std::filesystem::file_size(file)), end);
      if (!end.empty())
        return {{}, damaged(file, end)};
      return std::move(answers.front());
    }
  } // namespace

  ContactProblem read_fclib(const std::string &file)
  {
    ReadProblem answer = read_alone(file);
    if (!answer.error.empty())
      throw BadContactFile(answer.error);
    return std::move(answer.problem);
  }

  std::vector<ReadProblem> read_fclib(const std::vector<std::string> &files)
  {
    constexpr std::size_t most_files = 64;
    constexpr double most_bytes = 0x1p24;
    std::vector<ReadProblem> answers;
    for (std::size_t first = 0, next = 0; first < files.size(); first = next) {
      std::vector<std::string> batch;
      double bytes = 0.;
      for (; next < files.size() && batch.size() < most_files; ++next) {
        std::error_code error;
        const auto size = std::filesystem::file_size(files[next], error);
        if (!batch.empty() && (error || bytes + double(size) > most_bytes))
          break;
        bytes += error ? 0. : double(size);
        batch.push_back(files[next]);
      }
      std::string end;
      std::vector<ReadProblem> found;
      if (batch.size() > 1)
        found = read_in_a_copy(batch, bytes, end);
      // a damaged one may have damaged the others in the copy
      if (found.empty() || std::any_of(found.begin(), found.end(),
                                       [](const ReadProblem &answer) {
                                         return !answer.error.empty();
                                       })) {
        found.clear();
        for (const std::string &file : batch)
          found.push_back(read_alone(file));
      }
      std::move(found.begin(), found.end(), std::back_inserter(answers));
    }
    return answers;
  }
} // namespace nsfd
