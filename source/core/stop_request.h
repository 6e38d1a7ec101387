#pragma once

namespace nsfd
{
  /**
   * A step that is left because the run was asked to end. No std::exception:
   * what handles or reports errors must not take it for one.
   */
  struct StopRequested {
  };

  /**
   * Signals that ask for an end: HUP, INT, QUIT, TERM, USR1, XCPU, and PIPE
   * with a standard output that nobody reads any more. A file that may not
   * grow (XFSZ) is a failed write instead.
   */
  namespace stop_request
  {
    /**
     * From here on such a signal ends the process at once with exit code 4,
     * with a sentence on standard error if this is the @p first rank. HUP stays
     * ignored where it is (nohup).
     */
    void end_at_signals(bool first);

    /**
     * From here on it is kept, for requested() and within Interruptible.
     * Another signal, a second later, ends the process. With
     * @p watches_output a standard output without a reader counts as one.
     */
    void catch_signals(bool watches_output);

    /** This process was asked to end; others may know nothing of it yet. */
    bool requested();

    /** Who has asked, for a sentence: "SIGTERM", "a closed standard output". */
    const char *reason();

    /**
     * While one lives, reductions over as many ranks as the run has leave by
     * StopRequested, on all of them in the same one, once the request is 0.3 s
     * old: steps that take no longer are finished. Collective.
     */
    class Interruptible
    {
    public:
      explicit Interruptible(int n_ranks);
      ~Interruptible();
      Interruptible(const Interruptible &) = delete;
      Interruptible &operator=(const Interruptible &) = delete;
    };

    /**
     * Also without a request, steps are left from @p time on (s of CPU of this
     * process, as of cpu_seconds()); 0: not.
     */
    void leave_steps_at(double time);

    /** This rank of @p n_ranks wants to leave its step now. Not collective. */
    bool is_due(int n_ranks);

    /** For loops of one process without reductions. */
    inline void leave_if_due()
    {
      if (is_due(1))
        throw StopRequested();
    }
  } // namespace stop_request
} // namespace nsfd
