#pragma once

#include <sys/mount.h>

#include <filesystem>
#include <string>

namespace end_to_end
{
  /** A small file system in memory, gone with the object. */
  class Disk
  {
  public:
    Disk(const std::filesystem::path &place, const std::string &size)
        : place_(place)
    {
      std::filesystem::create_directories(place);
      mounted_ = mount("nsfd", place.c_str(), "tmpfs", 0,
                       ("size=" + size).c_str()) == 0;
    }
    ~Disk()
    {
      if (mounted_)
        umount2(place_.c_str(), MNT_DETACH);
    }
    Disk(const Disk &) = delete;
    Disk &operator=(const Disk &) = delete;

    bool mounted() const { return mounted_; }
    bool make_read_only() const
    {
      return mount("nsfd", place_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY,
                   nullptr) == 0;
    }

  private:
    const std::filesystem::path place_;
    bool mounted_ = false;
  };
} // namespace end_to_end
