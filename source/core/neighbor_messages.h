#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * One message to and one from each of a few ranks, on their way while this
   * one works: fill `out`, start(), work, finish(), read `in`. Empty ones are
   * not sent; both sides know how long they are.
   */
  template <typename T>
  class NeighborMessages
  {
  public:
    struct Message {
      int rank = 0;
      std::vector<T> out, in;
    };
    std::vector<Message> messages;

    void start(const MPI_Comm communicator, const int tag)
    {
      requests_.clear();
      for (Message &m : messages)
        if (!m.in.empty())
          MPI_Irecv(m.in.data(), bytes(m.in), MPI_BYTE, m.rank, tag,
                    communicator, &requests_.emplace_back());
      for (const Message &m : messages)
        if (!m.out.empty())
          MPI_Isend(m.out.data(), bytes(m.out), MPI_BYTE, m.rank, tag,
                    communicator, &requests_.emplace_back());
    }

    void finish()
    {
      if (!requests_.empty())
        MPI_Waitall(int(requests_.size()), requests_.data(),
                    MPI_STATUSES_IGNORE);
      requests_.clear();
    }

  private:
    static int bytes(const std::vector<T> &values)
    {
      return int(values.size() * sizeof(T));
    }
    std::vector<MPI_Request> requests_;
  };
} // namespace nsfd
