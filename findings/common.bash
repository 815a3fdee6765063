# Sourced by the scripts of this folder. It makes a temporary folder, unpacks pinned packages of Debian in it, and compares
# what a script sees with what was seen when it was written. Nothing outside of the temporary folder is touched.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
changed=0

# unpack SUITE ARCHITECTURE PACKAGE[=VERSION]...
# Downloads packages of a Debian release with all that they depend on, and unpacks them into a folder, $root. apt refuses a
# version that the archive no longer has, so a script never runs with another version than it names. If FINDINGS_KEEP names
# a folder, what is unpacked stays there for the next run.
unpack() {
  local suite=$1 architecture=$2 apt=$work/apt machine
  case $architecture in amd64) machine=x86_64 ;; arm64) machine=aarch64 ;; esac
  shift 2
  echo "packages of $suite for $architecture: $*"
  root=${FINDINGS_KEEP:-$work}/$suite-$architecture-$(echo "$*" | cksum | cut -d' ' -f1)
  libraries=$root/usr/lib/$machine-linux-gnu
  if [ -e "$root.complete" ]; then return; fi
  rm -rf "$root"
  mkdir -p "$apt/lists/partial" "$apt/archives/partial" "$root"/usr/{bin,sbin,lib,lib64}
  for folder in bin sbin lib lib64; do ln -s "usr/$folder" "$root/$folder"; done
  : >"$apt/status"
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] ${DEBIAN_MIRROR:-http://deb.debian.org/debian} $suite main" \
    >"$apt/sources.list"
  local options=(-qq -o "Dir::Etc::SourceList=$apt/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o Dir::Etc::Preferences=/dev/null -o Dir::Etc::PreferencesParts=/dev/null -o "Dir::State::Lists=$apt/lists"
    -o "Dir::State::Status=$apt/status" -o "Dir::Cache=$apt" -o "Dir::Cache::Archives=$apt/archives"
    -o "APT::Architecture=$architecture" -o "APT::Architectures=$architecture" -o APT::Install-Recommends=false
    -o APT::Sandbox::User=root -o Acquire::Languages=none -o Dpkg::Use-Pty=0)
  apt-get "${options[@]}" update
  apt-get "${options[@]}" --yes --download-only install "$@" >"$apt/log"
  printf '%s\0' "$apt"/archives/*.deb | xargs -0 -P 2 -n 1 sh -c 'dpkg-deb --fsys-tarfile "$1" |
    tar -x --keep-directory-symlink --no-same-owner --exclude="./usr/share/doc/*" --exclude="./usr/share/locale/*" -C "$0"' "$root"
  rm -rf "$apt"
  if [ -n "${FINDINGS_KEEP:-}" ]; then touch "$root.complete"; fi
}

# run PROGRAM [ARGUMENT...]: with the loader and the libraries of $root, not those of this system.
run() { "$root/lib64/ld-linux-x86-64.so.2" --library-path "$libraries:$libraries/blas:$libraries/lapack" "$@"; }

# python [ARGUMENT...]: Python of $root, a release of Debian 12.
python() { PYTHONHOME=$root/usr run "$root/usr/bin/python3.11" "$@"; }

# povray_says <STATEMENTS: the words that POV-Ray of $root prints behind RESULT in a scene of these statements.
povray_says() {
  { printf '#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { location -z }\n'; cat; } >scene.pov
  run "$root/usr/bin/povray" +Iscene.pov +W4 +H4 -F -D +WT1 >log 2>&1 || true
  sed -n 's/.*RESULT //p' log
}

# guess TEXT: what one would expect.
guess() { echo "guess: $*"; }

# seen WHAT EXPECTED ACTUAL: prints a result, and notes when it is not the one that was seen before.
seen() {
  if [ "$2" = "$3" ]; then
    echo "seen:  $1: $3"
  else
    echo "CHANGED: $1: $3, was $2"
    changed=1
  fi
}

# finish: ends the script, with 1 if anything was different.
finish() {
  if [ "$changed" -eq 0 ]; then echo "unchanged"; else echo "the behaviour has changed"; fi
  exit "$changed"
}
