#!/usr/bin/env bash
# Run roverlink on an aarch64 that QEMU emulates: `make test-aarch64`.
#
# .aarch64/root is a Debian 12 for arm64. It is kept for later runs, with the Python packages that roverlink needs.
# The files of this project, as they are now, are copied into it. Then checks.py runs in it.
#
# Exit code 0: all checks passed; 1: a check failed; 2: root or a tool is missing, or Debian cannot be installed.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD/.aarch64/root
packages=$(sort -u tests/aarch64/debian-packages | paste -sd,)

if [ "$(id -u)" != 0 ]; then
  echo "make test-aarch64 needs root for chroot and mount: sudo make test-aarch64" >&2
  exit 2
fi
for tool in debootstrap qemu-aarch64-static; do
  if ! command -v $tool >/dev/null; then
    echo "missing: $tool; on Debian and Ubuntu: apt-get install debian-archive-keyring debootstrap qemu-user-static" >&2
    exit 2
  fi
done
if ! ls dist/*_aarch64.whl >/dev/null; then
  echo "make dist has made no wheel for aarch64 (see above)" >&2
  exit 2
fi
# With a mount namespace of its own, this run leaves no mount behind, however it ends.
if [ -z "${OWN_MOUNTS:-}" ]; then
  OWN_MOUNTS=yes exec unshare --mount --propagation private "$0"
fi

# The kernel starts QEMU for programs of aarch64 if this rule is registered. Some systems do so when they boot. Since
# Linux 6.7 the rule lives as long as the mount.
rules=/proc/sys/fs/binfmt_misc
[ -e $rules/register ] || mount -t binfmt_misc binfmt_misc $rules
[ -e $rules/qemu-aarch64 ] || cat /usr/lib/binfmt.d/qemu-aarch64.conf >$rules/register

if [ "$(cat .aarch64/packages 2>/dev/null)" != "$packages" ]; then
  echo "== installing Debian 12 for arm64 in .aarch64/root; this downloads packages and can take half an hour (log: .aarch64/log)"
  rm -rf .aarch64
  mkdir .aarch64
  if ! debootstrap --arch=arm64 --variant=minbase --include="$packages" bookworm "$root" >.aarch64/log 2>&1; then
    tail -n 20 .aarch64/log >&2
    exit 2
  fi
  echo "$packages" >.aarch64/packages
fi

rm -rf "$root/src"
mkdir "$root/src"
{ git ls-files -z --cached --others --exclude-standard; printf '%s\0' dist/*.whl; } |
  tar --create --null --files-from - | tar --extract --directory "$root/src"
# The network of this computer: its name servers, and the certificates that it trusts.
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
mount -t proc proc "$root/proc"
exec chroot "$root" env -i PATH=/usr/bin:/bin HOME=/root LANG=C.UTF-8 python3 -u /src/tests/aarch64/checks.py
