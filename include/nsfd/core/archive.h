#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd
{
  /** A checkpoint that cannot be read; the text says which and why. */
  class BadCheckpoint : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /**
   * What a part carries from one step to the next, by name. The same lines
   * write it to a checkpoint and read it back; a part has them in a function
   * `serialize(Archive &)`. Everything here is collective. Values come back bit
   * by bit; those over bodies and points also on another number of ranks.
   * @throws BadCheckpoint if what is read is not there, or of another size.
   */
  class Archive
  {
  public:
    explicit Archive(const bool reads) : reads_(reads) {}
    virtual ~Archive() = default;
    Archive(const Archive &) = delete;
    Archive &operator=(const Archive &) = delete;

    /** True if values come from the archive, false if they go into it. */
    bool reads() const { return reads_; }

    /** One value per unknown of the bodies, or none at all. */
    virtual void bodies(const std::string &name,
                        std::vector<double> &values) = 0;

    /**
     * The same number of values for each of the points, those shared with
     * other ranks included, or none at all.
     */
    virtual void points(const std::string &name,
                        std::vector<double> &values) = 0;
    virtual void points(const std::string &name,
                        std::vector<std::uint8_t> &values) = 0;

    /**
     * What the materials of the cells keep, cell by cell as
     * first_histories() has it, or none at all.
     */
    virtual void histories(const std::string &name,
                           std::vector<double> &values) = 0;

    /** The same number of values for each of the cells, or none at all. */
    virtual void cells(const std::string &name,
                       std::vector<double> &values) = 0;

    /** The same on all ranks; what goes in is that of the first one. */
    virtual void common(const std::string &name,
                        std::vector<double> &values) = 0;

    /** Only the first rank has it. */
    virtual void on_root(const std::string &name,
                         std::vector<double> &values) = 0;
    virtual void on_root(const std::string &name, std::string &text) = 0;

    /** Numbers, flags and counters, the same on all ranks. */
    template <typename... Numbers>
    void numbers(const std::string &name, Numbers &...number)
    {
      std::vector<double> values = {static_cast<double>(number)...};
      const std::size_t n = values.size();
      common(name, values);
      if (values.size() != n)
        throw BadCheckpoint(name + " has another number of values");
      std::size_t k = 0;
      ((number = static_cast<Numbers>(values[k++])), ...);
    }

    /** Names inside the scope belong to a part. */
    class Part
    {
    public:
      Part(Archive &archive, const std::string &name)
          : archive_(archive), length_(archive.part_.size())
      {
        archive.part_ += name + '/';
      }
      ~Part() { archive_.part_.resize(length_); }
      Part(const Part &) = delete;
      Part &operator=(const Part &) = delete;

    private:
      Archive &archive_;
      const std::size_t length_;
    };

  protected:
    std::string path(const std::string &name) const { return part_ + name; }

  private:
    const bool reads_;
    std::string part_;
  };
} // namespace nsfd
