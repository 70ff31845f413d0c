//! Filters what graphics drivers write to standard error of their own accord: useless lines are dropped.

/// Runs `work` without the drivers' complaint about a missing Wayland folder: a Vulkan layer looks for Wayland whenever
/// adapters are listed, even if nobody asked for it. All other output stays.
#[cfg(unix)]
pub(super) fn with_filtered_messages<T>(work: impl FnOnce() -> T) -> T {
    if std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| !folder.is_empty()) {
        return work();
    }
    let Ok(_capture) = unix::StderrCapture::begin() else { return work() };
    work()
}

/// Runs `work`.
#[cfg(not(unix))]
pub(super) fn with_filtered_messages<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// The useful part of what drivers wrote.
#[cfg(unix)]
fn useful_lines(written: &[u8]) -> Vec<u8> {
    let lines = written.split_inclusive(|byte| *byte == b'\n');
    lines.filter(|line| !line.starts_with(b"error: XDG_RUNTIME_DIR is ")).flatten().copied().collect()
}

#[cfg(unix)]
mod unix {
    use std::fs::File;
    use std::io::{self, Read, Seek, Write};
    use std::os::fd::OwnedFd;

    /// Redirects standard error to a file until this is dropped; then writes the useful part to standard error.
    pub(super) struct StderrCapture {
        standard_error: OwnedFd,
        file: File,
    }

    impl StderrCapture {
        pub(super) fn begin() -> io::Result<Self> {
            let file = tempfile::tempfile()?;
            let standard_error = rustix::io::dup(rustix::stdio::stderr())?;
            rustix::stdio::dup2_stderr(&file)?;
            Ok(Self { standard_error, file })
        }

        fn end(&mut self) -> io::Result<()> {
            rustix::stdio::dup2_stderr(&self.standard_error)?;
            let mut written = Vec::new();
            self.file.rewind()?;
            self.file.read_to_end(&mut written)?;
            io::stderr().write_all(&super::useful_lines(&written))
        }
    }

    impl Drop for StderrCapture {
        fn drop(&mut self) {
            if let Err(error) = self.end() {
                log::debug!("what drivers wrote is lost: {error}");
            }
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::useful_lines;

    #[test]
    fn what_a_driver_has_to_say_stays() {
        let written = b"MESA: warning\nerror: XDG_RUNTIME_DIR is invalid or not set in the environment.\nlast";
        assert_eq!(useful_lines(written), b"MESA: warning\nlast", "but for the line that tells nothing");
    }
}
