#pragma once

#include <hdf5.h>

#include <utility>

namespace nsfd::stored
{
  /** An identifier of HDF5, closed with the object. */
  class Handle
  {
  public:
    using Close = herr_t (*)(hid_t);

    Handle(const hid_t id, const Close close) : id_(id), close_(close) {}
    ~Handle()
    {
      if (id_ >= 0)
        close_(id_);
    }
    Handle(Handle &&other) noexcept
        : id_(std::exchange(other.id_, -1)), close_(other.close_)
    {
    }
    Handle(const Handle &) = delete;
    Handle &operator=(const Handle &) = delete;

    explicit operator bool() const { return id_ >= 0; }
    operator hid_t() const { return id_; }

  private:
    hid_t id_;
    Close close_;
  };

  /** Failures are reported by the caller, not printed by the library. */
  class QuietHdf5
  {
  public:
    QuietHdf5()
    {
      H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
    QuietHdf5(const QuietHdf5 &) = delete;
    QuietHdf5 &operator=(const QuietHdf5 &) = delete;

  private:
    H5E_auto2_t function_ = nullptr;
    void *data_ = nullptr;
  };
} // namespace nsfd::stored
