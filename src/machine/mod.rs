//! The resources of the machine: free memory, checked before a scene is built so that a large scene is refused in words
//! instead of the process being killed; and threads that are awake when there is work for them.

mod free_memory;
#[cfg(target_os = "linux")]
mod linux;
mod processors;
pub mod threads;

use std::sync::OnceLock;

pub use free_memory::FreeMemory;

/// The bytes that the user allows instead of what is free.
static ALLOWED_BYTES: OnceLock<u64> = OnceLock::new();

/// Lets this process take this many bytes, whatever is free. Only the first call counts.
pub fn allow_memory(bytes: u64) {
    if ALLOWED_BYTES.set(bytes).is_err() {
        log::debug!("how much memory may be taken was said before");
    }
}

/// The memory that this process may still take; none where the system does not tell.
pub fn free_memory() -> Option<FreeMemory> {
    match ALLOWED_BYTES.get() {
        Some(&bytes) => Some(FreeMemory { bytes, whose: "as --memory says" }),
        None => free_of_system(),
    }
}

/// The most memory that this process has taken, bytes; none where the system does not tell.
pub fn peak_memory() -> Option<u64> {
    #[cfg(target_os = "linux")]
    return linux::peak();
    #[cfg(not(target_os = "linux"))]
    None
}

fn free_of_system() -> Option<FreeMemory> {
    #[cfg(target_os = "linux")]
    return linux::free();
    #[cfg(not(target_os = "linux"))]
    None
}

/// A number of bytes in words.
pub fn bytes_text(bytes: u64) -> String {
    match bytes as f64 {
        few if few < 1e3 => format!("{few:.0} bytes"),
        few if few < 1e6 => format!("{:.0} kB", few / 1e3),
        few if few < 1e9 => format!("{:.0} MB", few / 1e6),
        many => format!("{:.1} GB", many / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_told_as_people_count_them() {
        assert_eq!(bytes_text(64), "64 bytes");
        assert_eq!(bytes_text(34_567), "35 kB");
        assert_eq!(bytes_text(345_678_901), "346 MB");
        assert_eq!(bytes_text(12_345_678_901), "12.3 GB");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_tells() {
        let free = free_memory().expect("Linux tells");
        assert!((1 << 20..1 << 50).contains(&free.bytes), "{free:?}");
        assert!(peak_memory().is_some_and(|peak| peak > 1 << 20), "some megabytes");
    }
}
