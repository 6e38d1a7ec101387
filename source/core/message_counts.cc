#include "nsfd/core/message_counts.h"

#include "cost.h"

#include <mpi.h>

/**
 * The profiling interface of MPI: these functions stand before those of the
 * library, for the libraries that send for us as well, and count. Time in
 * those that wait belongs to its own line of the costs.
 */
namespace
{
  nsfd::MessageCounts counts;

  bool alone(const MPI_Comm communicator)
  {
    int size = 1;
    PMPI_Comm_size(communicator, &size);
    return size < 2;
  }

  double size_of(const MPI_Datatype type)
  {
    int size = 0;
    if (type != MPI_DATATYPE_NULL)
      PMPI_Type_size(type, &size);
    return double(size);
  }

  void count_message(const int n, const MPI_Datatype type,
                     const MPI_Comm communicator)
  {
    if (alone(communicator))
      return;
    ++counts.messages;
    counts.message_bytes += n * size_of(type);
  }

  template <typename Call>
  int waiting(const Call &call)
  {
    if (alone(MPI_COMM_WORLD))
      return call();
    const nsfd::Charge charge(nsfd::Cost::messages);
    return call();
  }

  template <typename Call>
  int collective(const double bytes, const MPI_Comm communicator,
                 const Call &call)
  {
    if (alone(communicator))
      return call();
    ++counts.collectives;
    counts.collective_bytes += bytes;
    return waiting(call);
  }

  double bytes_of(const void *send, const int n_send, const MPI_Datatype type,
                  const int n_here, const MPI_Datatype type_here)
  {
    return send == MPI_IN_PLACE ? n_here * size_of(type_here)
                                : n_send * size_of(type);
  }

  /** Of one number per rank. */
  double bytes_of(const int *n, const MPI_Datatype type,
                  const MPI_Comm communicator)
  {
    int size = 0;
    PMPI_Comm_size(communicator, &size);
    double sum = 0.;
    for (int r = 0; r < size; ++r)
      sum += n[r];
    return sum * size_of(type);
  }

  int rank_in(const MPI_Comm communicator)
  {
    int rank = 0;
    PMPI_Comm_rank(communicator, &rank);
    return rank;
  }
} // namespace

namespace nsfd
{
  MessageCounts message_counts() { return counts; }

  void begin_message_counts() { counts = MessageCounts(); }
} // namespace nsfd

extern "C" {

int MPI_Send(const void *data, int n, MPI_Datatype type, int to, int tag,
             MPI_Comm comm)
{
  count_message(n, type, comm);
  return waiting([&] { return PMPI_Send(data, n, type, to, tag, comm); });
}

int MPI_Ssend(const void *data, int n, MPI_Datatype type, int to, int tag,
              MPI_Comm comm)
{
  count_message(n, type, comm);
  return waiting([&] { return PMPI_Ssend(data, n, type, to, tag, comm); });
}

int MPI_Rsend(const void *data, int n, MPI_Datatype type, int to, int tag,
              MPI_Comm comm)
{
  count_message(n, type, comm);
  return waiting([&] { return PMPI_Rsend(data, n, type, to, tag, comm); });
}

int MPI_Isend(const void *data, int n, MPI_Datatype type, int to, int tag,
              MPI_Comm comm, MPI_Request *request)
{
  count_message(n, type, comm);
  return PMPI_Isend(data, n, type, to, tag, comm, request);
}

int MPI_Issend(const void *data, int n, MPI_Datatype type, int to, int tag,
               MPI_Comm comm, MPI_Request *request)
{
  count_message(n, type, comm);
  return PMPI_Issend(data, n, type, to, tag, comm, request);
}

int MPI_Irsend(const void *data, int n, MPI_Datatype type, int to, int tag,
               MPI_Comm comm, MPI_Request *request)
{
  count_message(n, type, comm);
  return PMPI_Irsend(data, n, type, to, tag, comm, request);
}

int MPI_Sendrecv(const void *out, int n_out, MPI_Datatype type_out, int to,
                 int tag_out, void *in, int n_in, MPI_Datatype type_in,
                 int from, int tag_in, MPI_Comm comm, MPI_Status *status)
{
  count_message(n_out, type_out, comm);
  return waiting([&] {
    return PMPI_Sendrecv(out, n_out, type_out, to, tag_out, in, n_in, type_in,
                         from, tag_in, comm, status);
  });
}

int MPI_Recv(void *data, int n, MPI_Datatype type, int from, int tag,
             MPI_Comm comm, MPI_Status *status)
{
  return waiting(
      [&] { return PMPI_Recv(data, n, type, from, tag, comm, status); });
}

int MPI_Wait(MPI_Request *request, MPI_Status *status)
{
  return waiting([&] { return PMPI_Wait(request, status); });
}

int MPI_Waitall(int n, MPI_Request *requests, MPI_Status *statuses)
{
  return waiting([&] { return PMPI_Waitall(n, requests, statuses); });
}

int MPI_Waitany(int n, MPI_Request *requests, int *index, MPI_Status *status)
{
  return waiting([&] { return PMPI_Waitany(n, requests, index, status); });
}

int MPI_Waitsome(int n, MPI_Request *requests, int *n_done, int *indices,
                 MPI_Status *statuses)
{
  return waiting(
      [&] { return PMPI_Waitsome(n, requests, n_done, indices, statuses); });
}

int MPI_Barrier(MPI_Comm comm)
{
  return collective(0., comm, [&] { return PMPI_Barrier(comm); });
}

int MPI_Allreduce(const void *send, void *receive, int n, MPI_Datatype type,
                  MPI_Op op, MPI_Comm comm)
{
  return collective(n * size_of(type), comm, [&] {
    return PMPI_Allreduce(send, receive, n, type, op, comm);
  });
}

int MPI_Reduce(const void *send, void *receive, int n, MPI_Datatype type,
               MPI_Op op, int root, MPI_Comm comm)
{
  return collective(n * size_of(type), comm, [&] {
    return PMPI_Reduce(send, receive, n, type, op, root, comm);
  });
}

int MPI_Reduce_scatter(const void *send, void *receive, const int *n,
                       MPI_Datatype type, MPI_Op op, MPI_Comm comm)
{
  return collective(bytes_of(n, type, comm), comm, [&] {
    return PMPI_Reduce_scatter(send, receive, n, type, op, comm);
  });
}

int MPI_Scan(const void *send, void *receive, int n, MPI_Datatype type,
             MPI_Op op, MPI_Comm comm)
{
  return collective(n * size_of(type), comm, [&] {
    return PMPI_Scan(send, receive, n, type, op, comm);
  });
}

int MPI_Exscan(const void *send, void *receive, int n, MPI_Datatype type,
               MPI_Op op, MPI_Comm comm)
{
  return collective(n * size_of(type), comm, [&] {
    return PMPI_Exscan(send, receive, n, type, op, comm);
  });
}

int MPI_Bcast(void *data, int n, MPI_Datatype type, int root, MPI_Comm comm)
{
  return collective(rank_in(comm) == root ? n * size_of(type) : 0., comm,
                    [&] { return PMPI_Bcast(data, n, type, root, comm); });
}

int MPI_Gather(const void *send, int n_send, MPI_Datatype type, void *receive,
               int n, MPI_Datatype type_receive, int root, MPI_Comm comm)
{
  return collective(bytes_of(send, n_send, type, n, type_receive), comm, [&] {
    return PMPI_Gather(send, n_send, type, receive, n, type_receive, root,
                       comm);
  });
}

int MPI_Gatherv(const void *send, int n_send, MPI_Datatype type, void *receive,
                const int *n, const int *first, MPI_Datatype type_receive,
                int root, MPI_Comm comm)
{
  return collective(send == MPI_IN_PLACE ? 0. : n_send * size_of(type), comm,
                    [&] {
                      return PMPI_Gatherv(send, n_send, type, receive, n, first,
                                          type_receive, root, comm);
                    });
}

int MPI_Allgather(const void *send, int n_send, MPI_Datatype type,
                  void *receive, int n, MPI_Datatype type_receive,
                  MPI_Comm comm)
{
  return collective(bytes_of(send, n_send, type, n, type_receive), comm, [&] {
    return PMPI_Allgather(send, n_send, type, receive, n, type_receive, comm);
  });
}

int MPI_Allgatherv(const void *send, int n_send, MPI_Datatype type,
                   void *receive, const int *n, const int *first,
                   MPI_Datatype type_receive, MPI_Comm comm)
{
  return collective(
      bytes_of(send, n_send, type, n[rank_in(comm)], type_receive), comm, [&] {
        return PMPI_Allgatherv(send, n_send, type, receive, n, first,
                               type_receive, comm);
      });
}

int MPI_Scatter(const void *send, int n_send, MPI_Datatype type, void *receive,
                int n, MPI_Datatype type_receive, int root, MPI_Comm comm)
{
  int size = 1;
  PMPI_Comm_size(comm, &size);
  return collective(
      rank_in(comm) == root ? double(n_send) * size * size_of(type) : 0., comm,
      [&] {
        return PMPI_Scatter(send, n_send, type, receive, n, type_receive, root,
                            comm);
      });
}

int MPI_Scatterv(const void *send, const int *n_send, const int *first,
                 MPI_Datatype type, void *receive, int n,
                 MPI_Datatype type_receive, int root, MPI_Comm comm)
{
  return collective(rank_in(comm) == root ? bytes_of(n_send, type, comm) : 0.,
                    comm, [&] {
                      return PMPI_Scatterv(send, n_send, first, type, receive,
                                           n, type_receive, root, comm);
                    });
}

int MPI_Alltoall(const void *send, int n_send, MPI_Datatype type, void *receive,
                 int n, MPI_Datatype type_receive, MPI_Comm comm)
{
  int size = 1;
  PMPI_Comm_size(comm, &size);
  return collective(size * bytes_of(send, n_send, type, n, type_receive), comm,
                    [&] {
                      return PMPI_Alltoall(send, n_send, type, receive, n,
                                           type_receive, comm);
                    });
}

int MPI_Alltoallv(const void *send, const int *n_send, const int *first,
                  MPI_Datatype type, void *receive, const int *n,
                  const int *first_receive, MPI_Datatype type_receive,
                  MPI_Comm comm)
{
  return collective(send == MPI_IN_PLACE ? bytes_of(n, type_receive, comm)
                                         : bytes_of(n_send, type, comm),
                    comm, [&] {
                      return PMPI_Alltoallv(send, n_send, first, type, receive,
                                            n, first_receive, type_receive,
                                            comm);
                    });
}
}
