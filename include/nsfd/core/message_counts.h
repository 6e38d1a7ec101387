#pragma once

namespace nsfd
{
  /** What a rank has sent to others, the messages of libraries included. */
  struct MessageCounts {
    double messages = 0., message_bytes = 0.; ///< to one other rank each
    double collectives = 0.;      ///< reductions, gathers, barriers, ...
    double collective_bytes = 0.; ///< that this rank has put in
  };

  /** Of this rank since begin_costs(). */
  MessageCounts message_counts();
  void begin_message_counts();
} // namespace nsfd
