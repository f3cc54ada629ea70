// SPDX-License-Identifier: BSD-3-Clause
/* Preloaded into a program: counts every call that changes a file, and kills the
 * process before the one of number FIRN_KILL_AT (1, 2, …). With FIRN_KILL_TORN
 * set, half of that write's bytes reach the file first. FIRN_KILL_LOG names a
 * file to which the name of every call is appended.
 *
 * SIGKILL from inside is what `kill -9` does from outside: nothing is flushed,
 * no handler runs; what was written before stays with the system. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static long calls = 0;

/* One more call. True if the process is to die in this one. */
static int is_last(const char* name) {
  const char* at = getenv("FIRN_KILL_AT");
  const char* log = getenv("FIRN_KILL_LOG");
  ++calls;
  if (log != NULL) {
    const int fd = (int)syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND, 0600);
    char line[64];
    const int length = snprintf(line, sizeof line, "%s\n", name);
    syscall(SYS_write, fd, line, (size_t)length);
    syscall(SYS_close, fd);
  }
  return at != NULL && calls == atol(at);
}

static int torn(void) { return getenv("FIRN_KILL_TORN") != NULL; }

static void die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void* data, size_t size) {
  if (is_last("write")) {
    if (torn()) syscall(SYS_write, fd, data, size / 2);
    die();
  }
  return REAL(write)(fd, data, size);
}

ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  if (is_last("pwrite")) {
    if (torn()) syscall(SYS_pwrite64, fd, data, size / 2, at);
    die();
  }
  return REAL(pwrite)(fd, data, size, at);
}

ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) {
  if (is_last("pwrite")) {
    if (torn()) syscall(SYS_pwrite64, fd, data, size / 2, at);
    die();
  }
  return REAL(pwrite64)(fd, data, size, at);
}

#define COUNTED(result, name, parameters, arguments) \
  result name parameters {                           \
    if (is_last(#name)) die();                       \
    return REAL(name) arguments;                     \
  }

COUNTED(ssize_t, writev, (int fd, const struct iovec* parts, int count), (fd, parts, count))
COUNTED(ssize_t, pwritev, (int fd, const struct iovec* parts, int count, off_t at),
        (fd, parts, count, at))
COUNTED(int, truncate, (const char* path, off_t size), (path, size))
COUNTED(int, ftruncate, (int fd, off_t size), (fd, size))
COUNTED(int, ftruncate64, (int fd, off64_t size), (fd, size))
COUNTED(int, fallocate, (int fd, int mode, off_t at, off_t size), (fd, mode, at, size))
COUNTED(int, posix_fallocate, (int fd, off_t at, off_t size), (fd, at, size))
COUNTED(int, posix_fallocate64, (int fd, off64_t at, off64_t size), (fd, at, size))
COUNTED(int, rename, (const char* from, const char* to), (from, to))
COUNTED(int, renameat, (int d1, const char* from, int d2, const char* to), (d1, from, d2, to))
COUNTED(int, fsync, (int fd), (fd))
COUNTED(int, fdatasync, (int fd), (fd))
COUNTED(int, unlink, (const char* path), (path))
COUNTED(int, remove, (const char* path), (path))

static int changes(int flags) { return (flags & (O_CREAT | O_TRUNC)) != 0; }

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = changes(flags) ? (mode_t)va_arg(rest, int) : 0;
  va_end(rest);
  if (changes(flags) && is_last("open")) die();
  return REAL(open)(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = changes(flags) ? (mode_t)va_arg(rest, int) : 0;
  va_end(rest);
  if (changes(flags) && is_last("open")) die();
  return REAL(open64)(path, flags, mode);
}
