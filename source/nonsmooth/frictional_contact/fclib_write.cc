#include "core/hdf5_file.h"
#include "core/output_folder.h"
#include "fclib.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    using stored::Handle;

    class Writer
    {
    public:
      explicit Writer(const std::string &name)
          : name_(name), file_(in_memory(name), H5Fclose)
      {
        demand(bool(file_));
      }

      /** On the disk in one go: HDF5 must never meet a full one. */
      void finish() const
      {
        demand(H5Fflush(file_, H5F_SCOPE_LOCAL) >= 0);
        const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
        demand(size > 0);
        std::string bytes(std::size_t(size), '\0');
        demand(H5Fget_file_image(file_, bytes.data(), bytes.size()) == size);
        write_file_atomically(name_, bytes);
      }

      void group(const std::string &path) const
      {
        const Handle group(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT,
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Gclose);
        demand(bool(group));
      }
      void write(const std::string &path, const std::vector<double> &x) const
      {
        write(path, x.size(), x.data(), H5T_NATIVE_DOUBLE);
      }
      void write(const std::string &path, const std::vector<int> &x) const
      {
        write(path, x.size(), x.data(), H5T_NATIVE_INT);
      }
      void write(const std::string &path, const std::string &text) const
      {
        const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
        H5Tset_size(type, text.size() + 1);
        const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
        write(path, space, text.c_str(), type);
      }

    private:
      static hid_t in_memory(const std::string &name)
      {
        const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
        H5Pset_fapl_core(access, 1 << 16, false);
        return H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
      }
      void demand(const bool good) const
      {
        if (!good)
          throw BadContactFile(fmt::format("{}: it cannot be written", name_));
      }
      void write(const std::string &path, const hsize_t size, const void *data,
                 const hid_t type) const
      {
        const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
        write(path, space, data, type);
      }
      void write(const std::string &path, const Handle &space, const void *data,
                 const hid_t type) const
      {
        // without the time: the same problem is the same file
        const Handle untimed(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        H5Pset_obj_track_times(untimed, false);
        const Handle set(H5Dcreate2(file_, path.c_str(), type, space,
                                    H5P_DEFAULT, untimed, H5P_DEFAULT),
                         H5Dclose);
        demand(set &&
               H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
      }

      std::string name_;
      Handle file_;
    };

    void write_pair(const Writer &writer, const std::string &group,
                    const ContactProblem &problem, const std::vector<double> &r)
    {
      std::vector<double> u;
      relative_velocity(problem, r, u);
      writer.group(group);
      writer.write(group + "/u", u);
      writer.write(group + "/r", r);
    }
  } // namespace

  void write_fclib(const std::string &file, const ContactProblem &problem)
  {
    const stored::QuietHdf5 quiet;
    const Writer writer(file);
    const auto number = [](const std::size_t n) {
      return std::vector<int>{int(n)};
    };
    writer.group("/fclib_local");
    writer.write("/fclib_local/spacedim", number(problem.dimension));
    const std::string w = "/fclib_local/W";
    writer.group(w);
    writer.write(w + "/nzmax", number(problem.value.size()));
    writer.write(w + "/m", number(problem.n_rows()));
    writer.write(w + "/n", number(problem.n_rows()));
    writer.write(w + "/nz", std::vector<int>{-2});
    writer.write(w + "/p", problem.row_start);
    writer.write(w + "/i", problem.column);
    writer.write(w + "/x", problem.value);
    writer.group("/fclib_local/vectors");
    writer.write("/fclib_local/vectors/q", problem.q);
    writer.write("/fclib_local/vectors/mu", problem.friction);
    writer.group("/fclib_local/info");
    writer.write("/fclib_local/info/title", problem.title);
    writer.write("/fclib_local/info/description", problem.description);
    writer.write("/fclib_local/info/math_info", problem.math_info);
    if (!problem.solution.empty())
      write_pair(writer, "/solution", problem, problem.solution);
    if (!problem.guess.empty()) {
      writer.group("/guesses");
      writer.write("/guesses/number_of_guesses", number(1));
      write_pair(writer, "/guesses/1", problem, problem.guess);
    }
    writer.finish();
  }
} // namespace nsfd
