#include "lock_process.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include <fcntl.h>
#include <signal.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <vector>

namespace nsfd
{
  namespace
  {
    /** The upper limit, which ends a process without a word, is @p spare more.
     */
    void set_limit(const decltype(RLIMIT_CPU) resource, const double value,
                   const rlim_t spare = 0)
    {

      rlimit limit{};
      getrlimit(resource, &limit);
      const rlim_t most = rlim_t(value);
      limit.rlim_max = std::min(limit.rlim_max, most + spare);
      limit.rlim_cur = std::min(limit.rlim_max, most);
      setrlimit(resource, &limit);
    }

#if defined(__x86_64__) || defined(__aarch64__)
#ifdef __x86_64__
    constexpr unsigned int architecture = AUDIT_ARCH_X86_64;
#else
    constexpr unsigned int architecture = AUDIT_ARCH_AARCH64;
#endif

    /** Calls that start programs or change what is on the disk or the net. */
    const unsigned int forbidden_calls[] = {
        SYS_execve,         SYS_execveat, SYS_unlinkat,  SYS_renameat2,
        SYS_mkdirat,        SYS_linkat,   SYS_symlinkat, SYS_mknodat,
        SYS_fchmodat,       SYS_fchmod,   SYS_fchownat,  SYS_truncate,
        SYS_ftruncate,      SYS_socket,   SYS_ptrace,    SYS_mount,
        SYS_kill,
#ifdef SYS_renameat
        SYS_renameat,
#endif
#ifdef __x86_64__
        SYS_fork,           SYS_vfork,    SYS_unlink,    SYS_rename,
        SYS_mkdir,          SYS_rmdir,    SYS_link,      SYS_symlink,
        SYS_mknod,          SYS_chmod,    SYS_chown,     SYS_lchown,
        SYS_creat,
#endif
#ifdef SYS_openat2
        SYS_openat2,
#endif
#ifdef SYS_io_uring_setup
        SYS_io_uring_setup,
#endif
    };

    class CallFilter
    {
    public:
      CallFilter()
      {
        load(offsetof(seccomp_data, arch));
        unless_equal(architecture, 1);
        add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
        load(offsetof(seccomp_data, nr));
#ifdef __x86_64__
        // the calls of the 32-bit interface have other numbers
        if_at_least(0x40000000u);
        add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
#endif
        for (const unsigned int call : forbidden_calls) {
          if_equal(call, 1);
          add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
        }
        forbid_to_open_for_writing(SYS_openat, 2);
#ifdef __x86_64__
        forbid_to_open_for_writing(SYS_open, 1);
#endif
        add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
      }

      void install()
      {
        sock_fprog program{};
        program.len = static_cast<unsigned short>(code_.size());
        program.filter = code_.data();
        // what a kernel without filters allows, the limits still forbid
        if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0)
          prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
      }

    private:
      void add(const unsigned int code, const unsigned int k)
      {
        code_.push_back({static_cast<unsigned short>(code), 0, 0, k});
      }

      void load(const std::size_t offset)
      {
        add(BPF_LD | BPF_W | BPF_ABS, static_cast<unsigned int>(offset));
      }

      /** Go on with the next @p n instructions only if the value is @p k. */
      void if_equal(const unsigned int k, const unsigned char n)
      {
        code_.push_back({BPF_JMP | BPF_JEQ | BPF_K, 0, n, k});
      }

      void unless_equal(const unsigned int k, const unsigned char n)
      {
        code_.push_back({BPF_JMP | BPF_JEQ | BPF_K, n, 0, k});
      }

      void if_at_least(const unsigned int k)
      {
        code_.push_back({BPF_JMP | BPF_JGE | BPF_K, 0, 1, k});
      }

      void forbid_to_open_for_writing(const unsigned int call,
                                      const unsigned int argument)
      {
        if_equal(call, 4);
        // the lower half; these machines have it first
        load(offsetof(seccomp_data, args) + 8 * argument);
        code_.push_back({BPF_JMP | BPF_JSET | BPF_K, 0, 1,
                         O_WRONLY | O_RDWR | O_CREAT | O_TRUNC});
        add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES);
        add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
      }

      std::vector<sock_filter> code_;
    };

    void filter_calls() { CallFilter().install(); }
#else
    void filter_calls() {}
#endif
  } // namespace

  void lock_process(const ProcessLimits &limits)
  {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    set_limit(RLIMIT_CPU, std::ceil(limits.seconds), 5);
    set_limit(RLIMIT_DATA, limits.memory);
    set_limit(RLIMIT_CORE, 0.);
    set_limit(RLIMIT_FSIZE, 0.);
    filter_calls();
  }
} // namespace nsfd
