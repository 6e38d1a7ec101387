#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * A checkpoint as bytes: an HDF5 file whose user block, the first 512 bytes,
   * is a head of a few lines that HDF5 does not look at: what it is, the
   * version of its format, how long it is, and a checksum of all that follows.
   */
  namespace checkpoint_file
  {
    constexpr unsigned int format = 13;
    constexpr std::size_t head_size = 512;

    /** Number and commit of this program. */
    std::string program();

    /** Fill in the head. @p bytes are those of the HDF5 file. */
    void seal(std::vector<char> &bytes);

    /** Empty, or what is wrong with the bytes of a file. */
    std::string problem_of(const std::vector<char> &bytes);

    /** @throws std::runtime_error with the reason. */
    std::vector<char> read(const std::filesystem::path &file);

    /**
     * Put @p bytes into the place of `checkpoint.h5`. They are on the disk
     * before anything is renamed, what was there becomes
     * `checkpoint_previous.h5`, and whatever happens on the way leaves one of
     * the two whole. @throws std::runtime_error with the reason, and then
     * nothing has changed.
     */
    void put(const std::filesystem::path &folder,
             const std::vector<char> &bytes);

    /** Newest first. */
    std::vector<std::filesystem::path>
    candidates(const std::filesystem::path &folder);
  } // namespace checkpoint_file
} // namespace nsfd
