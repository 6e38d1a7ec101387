#pragma once

namespace nsfd
{
  class Archive;

  /**
   * Steps by bisection: the base step divides the time to the end evenly; level
   * l takes base / 2^l. A rejected step goes down one level at once; two
   * successes go up one level where the position allows it, so that every time
   * is a multiple of the base step again. Where a step up there is rejected
   * before as many have been taken as it was waited for, and four at least, the
   * next attempt waits for twice as many successes, else for half of them: what
   * is hard over many steps would cost one attempt in three. Times are computed
   * from counters, not summed.
   */
  class StepControl
  {
  public:
    /** @p base is shortened so that the end is met exactly. */
    StepControl(double end, double base, unsigned int maximum_bisections,
                double start = 0.);

    /** From @p start on by steps of exactly @p step, until the first of them
        that does not end before @p end. */
    static StepControl of_length(double step, double end, double start);

    bool finished() const { return base_count_ == n_base_; }
    double time() const;
    /** The end of the present step. */
    double next_time() const;
    double step() const;
    double base_step() const { return base_; }
    unsigned int level() const { return level_; }

    /** The step was taken. */
    void accept();
    bool can_bisect() const { return level_ < maximum_level_; }
    /** One level down. False if no finer level is allowed. */
    bool bisect();
    /** Down until step() <= @p limit, as far as levels go. */
    void limit(double limit);
    /** Do not go up above steps of @p limit at the next accept(). */
    void set_ceiling(double limit) { ceiling_ = limit; }

    unsigned int bisections() const { return n_bisections_; }

    void serialize(Archive &archive);

  private:
    double end_, base_, ceiling_;
    unsigned long long n_base_, base_count_ = 0, position_ = 0;
    unsigned int level_ = 0, maximum_level_, n_bisections_ = 0;
    unsigned int patience_ = 0;  ///< successes before the next way up
    unsigned int successes_ = 0; ///< since the last change of level
    bool on_trial_ = false;      ///< few successes since the way up
    double start_;
  };
} // namespace nsfd
