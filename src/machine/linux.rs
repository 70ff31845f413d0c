//! Memory on Linux: what the machine has left (`/proc/meminfo`), and what remains of it under the control groups of the
//! process (both versions of them) and under `ulimit`.

use std::fs;
use std::path::Path;

use super::free_memory::FreeMemory;

/// The least of what the machine, the control groups and the limits of the process leave.
pub(super) fn free() -> Option<FreeMemory> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let (status, limits) = (read("/proc/self/status"), read("/proc/self/limits"));
    let machine = kibibytes(&read("/proc/meminfo"), "MemAvailable:").map(|bytes| (bytes, "on this machine"));
    let address_space =
        left_of_limit(&limits, "Max address space", &status, "VmSize:").map(|bytes| (bytes, "by ulimit -v"));
    let data = left_of_limit(&limits, "Max data size", &status, "VmData:").map(|bytes| (bytes, "by ulimit -d"));
    let group = left_in_groups(&read("/proc/self/cgroup"), Path::new("/sys/fs/cgroup"));
    let group = group.map(|bytes| (bytes, "in its control group"));
    let least = [machine, address_space, data, group].into_iter().flatten().min_by_key(|(bytes, _)| *bytes);
    least.map(|(bytes, whose)| FreeMemory { bytes, whose })
}

/// The most memory that the process has had in use, bytes.
pub(super) fn peak() -> Option<u64> {
    kibibytes(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// Parses a line such as `VmSize:    1234 kB`, to bytes.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// What is left of a limit in `/proc/self/limits` (its soft value, bytes); none where there is no limit.
fn left_of_limit(limits: &str, limit: &str, status: &str, used: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix(limit))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(kibibytes(status, used).unwrap_or(0)))
}

/// What the control groups around the process leave: the least of its own and all above it.
fn left_in_groups(groups: &str, root: &Path) -> Option<u64> {
    let left = |line: &str| {
        // Version 2 is `0::/path`, version 1 is `4:memory:/path`.
        let [number, kinds, path] = line.splitn(3, ':').collect::<Vec<_>>().try_into().ok()?;
        let (root, files) = match kinds {
            "" if number == "0" => (root.to_owned(), ["memory.max", "memory.current", "inactive_file"]),
            kinds if kinds.split(',').any(|kind| kind == "memory") => {
                (root.join("memory"), ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"])
            }
            _ => return None,
        };
        let own = root.join(path.trim_start_matches('/'));
        // Inside a container the own group is the root, whatever the path says.
        let folders = own.ancestors().filter(|folder| folder.starts_with(&root));
        folders.filter_map(|folder| left_in_group(folder, files)).min()
    };
    groups.lines().filter_map(left).min()
}

fn left_in_group(folder: &Path, [most, used, reclaimable]: [&str; 3]) -> Option<u64> {
    let number = |file: &str| fs::read_to_string(folder.join(file)).ok()?.trim().parse::<u64>().ok();
    // "max" is no number: there is no limit.
    let most = number(most)?;
    let stat = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    // Cached files make room when memory is needed.
    let files = stat.lines().find_map(|line| line.strip_prefix(reclaimable)?.trim().parse::<u64>().ok()).unwrap_or(0);
    Some(most.saturating_sub(number(used)?.saturating_sub(files)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATUS: &str = "Name:\tgelatin\nVmSize:\t    2048 kB\nVmHWM:\t     100 kB\n";

    #[test]
    fn a_limit_of_the_process_is_what_is_left_of_it() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
                      Max address space         10485760             unlimited            bytes     \n\
                      Max data size             unlimited            unlimited            bytes     \n";
        assert_eq!(left_of_limit(limits, "Max address space", STATUS, "VmSize:"), Some(8 << 20), "10 MiB but for 2");
        assert_eq!(left_of_limit(limits, "Max data size", STATUS, "VmData:"), None, "no limit");
        assert_eq!(kibibytes(STATUS, "VmHWM:"), Some(100 << 10));
        assert_eq!(kibibytes(STATUS, "VmNone:"), None, "not told");
    }

    #[test]
    fn of_all_control_groups_the_tightest_counts() {
        let root = tempfile::tempdir().expect("a folder");
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a group");
            fs::write(path, text).expect("a file");
        };
        write("user/memory.max", "1000000\n");
        write("user/memory.current", "400000\n");
        write("user/memory.stat", "anon 5\ninactive_file 100000\n");
        write("user/gelatin/memory.max", "max\n");
        write("user/gelatin/memory.current", "300000\n");
        assert_eq!(left_in_groups("0::/user/gelatin\n", root.path()), Some(700_000), "files make room");
        write("user/gelatin/memory.max", "500000\n");
        assert_eq!(left_in_groups("0::/user/gelatin\n", root.path()), Some(200_000), "its own is tighter");
        assert_eq!(left_in_groups("0::/elsewhere\n", root.path()), None, "no limit");
        write("memory/job/memory.limit_in_bytes", "90000");
        write("memory/job/memory.usage_in_bytes", "100000");
        assert_eq!(left_in_groups("3:cpu:/\n4:memory:/job\n", root.path()), Some(0), "version 1, and used up");
    }
}
