//! The faults of a graphics device and of a picture, as sentences a person can act on.

/// A graphics device that is not available, or no longer there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// The machine offers no adapter at all.
    #[error(
        "no graphics adapter was found: install a Vulkan driver, for example the software one in Debian's and \
         Ubuntu's package `mesa-vulkan-drivers` (with `libvulkan1`)"
    )]
    NoAdapter,
    /// None of the adapters can draw what is needed.
    #[error(
        "none of the graphics adapters ({found}) can show this picture (compute shaders and 4× antialiasing{surface}): \
         install a Vulkan driver such as `mesa-vulkan-drivers`"
    )]
    Unsuitable {
        /// The adapters that were found.
        found: String,
        /// ", and this window" when one was asked for.
        surface: &'static str,
    },
    /// The adapter gave no device.
    #[error("the graphics adapter {adapter} could not be opened: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// The driver's message.
        reason: String,
    },
    /// The device has gone: unplugged, reset or out of memory.
    #[error("the graphics device was lost: {reason}; opening the window or running the command again may help")]
    Lost {
        /// The driver's message.
        reason: String,
    },
    /// The device refused a command.
    #[error("the graphics device refused a command: {reason}")]
    Refused {
        /// The driver's message.
        reason: String,
    },
}

/// A picture that cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// A side of the picture is zero.
    #[error("a picture of {width}×{height} pixels is empty: both sides must be at least 1")]
    EmptySize {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
    },
    /// A side of the picture is longer than the device can draw.
    #[error("a picture of {width}×{height} pixels is too large: this graphics device draws up to {limit} a side")]
    HugeSize {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
        /// The longest side, pixels.
        limit: u32,
    },
    /// The viewport is empty or extends beyond the picture.
    #[error("the viewport of {size:?} pixels at {origin:?} does not lie within the picture of {picture:?} pixels")]
    Viewport {
        /// Its upper left corner, pixels.
        origin: [u32; 2],
        /// Its width and height, pixels.
        size: [u32; 2],
        /// The picture's width and height, pixels.
        picture: [u32; 2],
    },
    /// More data than the device takes in one piece.
    #[error("the {what} take {bytes} bytes, more than the {limit} that this graphics device takes in one piece")]
    TooMuch {
        /// What is too large.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The device's limit.
        limit: u64,
    },
    /// A skin refers to a particle that does not exist.
    #[error("a skin needs {needed} particles, the draw list holds {given}")]
    MissingParticles {
        /// Number of particles that the skin needs.
        needed: usize,
        /// Number of particles in the draw list.
        given: usize,
    },
    /// The number of scalars differs from the number of particles.
    #[error("{scalars} scalars were given for {particles} particles: one each is needed")]
    ScalarCount {
        /// Number of scalars.
        scalars: usize,
        /// Number of particles.
        particles: usize,
    },
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
