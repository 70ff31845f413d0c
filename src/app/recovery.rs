//! Drafts: unsaved scenes kept in the state folder, so that a crash loses a few seconds at most. A draft is a scene file
//! with one more line. A thread writes it, and removes it when the scene is saved or the window is closed.
//!
//! ```text
//! drafts/PID.lock   held by its program as long as that lives: the system lets go of it after any crash
//! drafts/PID.ron    the unsaved scene, if there is one
//! ```
//!
//! If the lock of a draft can be taken, its program is dead. The draft is then offered, once, to the program with the lock.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};
use serde::{Deserialize, Serialize};

use super::sentence::sentence;
use crate::disk;
use crate::scene::Scene;
use crate::scene::view_settings::CameraSettings;
use crate::session::document::anchored;

/// The beginning of the line before the scene.
const MARK: &str = "// draft ";
/// What errors call the scene of a draft.
const DRAFT: &str = "draft";
/// A larger file is no draft.
const MAX_BYTES: u64 = 128 << 20;
/// Names tried before drafts are given up: programs in other containers may have the same process number.
const MAX_NAME_ATTEMPTS: u32 = 100;

/// An unsaved scene.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The camera's place.
    pub camera: CameraSettings,
    /// Where relative model paths start.
    pub base_dir: PathBuf,
    /// The scene's name.
    pub title: String,
    /// The file of the scene, if it has one.
    pub file: Option<PathBuf>,
    /// The checksum of that file as it was last read or written; none where that is not known.
    pub on_disk: Option<u64>,
}

/// The contents of the line before the scene.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct Header {
    title: String,
    file: Option<PathBuf>,
    #[serde(default)]
    on_disk: Option<u64>,
    unix_secs: i64,
}

/// A draft that a dead program has left behind. It is offered to nobody else while this value lives.
#[derive(Debug)]
pub struct Found {
    /// The scene; its model paths are absolute.
    pub scene: Scene,
    /// The scene's name.
    pub title: String,
    /// The file of the scene, if it has one.
    pub file: Option<PathBuf>,
    /// The checksum of that file as it was last read or written; none where that is not known.
    pub on_disk: Option<u64>,
    /// When it was kept, seconds since 1970.
    pub unix_secs: i64,
    draft: PathBuf,
    _lock: File,
}

impl Found {
    /// When the draft was kept, in a person's words: with the day unless it was today.
    pub fn when(&self) -> String {
        when(self.unix_secs, &Zoned::now())
    }

    /// Throws the draft away.
    pub fn discard(self) {
        remove(&self.draft);
        remove(&self.draft.with_extension("lock"));
    }
}

/// Finds the drafts of dead programs in a folder, the newest first. An unreadable draft is a line in the log.
pub fn find(folder: &Path) -> Vec<Found> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.filter_map(Result::ok).map(|entry| entry.path());
    let drafts = paths.filter(|path| path.extension().is_some_and(|ending| ending == "ron"));
    let mut found: Vec<Found> = drafts.filter_map(claim).collect();
    found.sort_by_key(|found| std::cmp::Reverse(found.unix_secs));
    found
}

/// Keeps the drafts of this program.
#[derive(Debug)]
pub struct Keeper {
    orders: Option<Sender<Order>>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
enum Order {
    Keep(Draft),
    Forget,
    Adopt(Box<Found>),
}

impl Keeper {
    /// Starts a keeper in a folder, which is created if need be. A draft is written `delay` after the first change in it.
    pub fn start(folder: &Path, delay: Duration) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let (lock, draft) = own_name(folder)?;
        disk::remove_left_behind(&draft.with_extension("lock"));
        let (orders, received) = channel();
        let thread = std::thread::spawn(move || {
            keep(&received, &draft, delay);
            remove(&draft.with_extension("lock"));
            drop(lock);
        });
        Ok(Self { orders: Some(orders), thread: Some(thread) })
    }

    /// Notes that the scene has unsaved changes, and what it is now.
    pub fn keep(&self, draft: Draft) {
        self.order(Order::Keep(draft));
    }

    /// Notes that the scene has no unsaved changes any more.
    pub fn forget(&self) {
        self.order(Order::Forget);
    }

    /// Notes that a found draft is now the scene. The draft is removed as soon as this program has one of its own.
    pub fn adopt(&self, found: Found) {
        self.order(Order::Adopt(Box::new(found)));
    }

    /// Closes the keeper. Its draft is removed unless the program failed. Returns when all is done.
    pub fn close(mut self, failed: bool) {
        if !failed {
            self.order(Order::Forget);
        }
        self.orders = None;
        if let Some(Err(_panic)) = self.thread.take().map(JoinHandle::join) {
            log::error!("the thread that keeps drafts has panicked");
        }
    }

    fn order(&self, order: Order) {
        if self.orders.as_ref().is_some_and(|orders| orders.send(order).is_err()) {
            log::debug!("the thread that keeps drafts has ended");
        }
    }
}

/// Obeys orders until the sender is gone.
fn keep(orders: &Receiver<Order>, file: &Path, delay: Duration) {
    let mut waiting: Option<(Draft, Instant)> = None;
    let mut adopted: Option<Box<Found>> = None;
    loop {
        let order = match &waiting {
            Some((_, due)) => orders.recv_timeout(due.saturating_duration_since(Instant::now())),
            None => orders.recv().map_err(|_gone| RecvTimeoutError::Disconnected),
        };
        match order {
            Ok(Order::Keep(draft)) => {
                let due = waiting.map_or_else(|| Instant::now() + delay, |(_, due)| due);
                waiting = Some((draft, due));
            }
            Ok(Order::Forget) => {
                waiting = None;
                if let Some(found) = adopted.take() {
                    found.discard();
                }
                remove(file);
            }
            Ok(Order::Adopt(found)) => adopted = Some(found),
            Err(RecvTimeoutError::Timeout) => {
                if write_logged(waiting.take(), file)
                    && let Some(found) = adopted.take()
                {
                    found.discard();
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                write_logged(waiting, file);
                return;
            }
        }
    }
}

/// Writes a draft, if there is one. Returns whether it is on the disk.
fn write_logged(waiting: Option<(Draft, Instant)>, file: &Path) -> bool {
    let Some((draft, _)) = waiting else { return false };
    match write(&draft, file) {
        Ok(()) => true,
        Err(error) => {
            log::error!("{}: no draft can be kept: {}", file.display(), sentence(&*error));
            false
        }
    }
}

fn write(draft: &Draft, file: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH)?;
    let mut scene = anchored(&draft.scene, &draft.base_dir);
    scene.view.camera = draft.camera;
    let header = Header {
        title: draft.title.clone(),
        // A name that is not valid Unicode cannot be written: the scene is then recovered without it.
        file: draft.file.clone().filter(|file| file.to_str().is_some()),
        on_disk: draft.on_disk,
        unix_secs: i64::try_from(now.as_secs())?,
    };
    let text = format!("{MARK}{}\n{}", serde_json::to_string(&header)?, scene.to_readable_ron(DRAFT)?);
    Ok(disk::write(file, text.as_bytes())?)
}

/// Takes a draft if its program is dead.
fn claim(draft: PathBuf) -> Option<Found> {
    let locked = draft.with_extension("lock");
    // Opening a pipe would wait for its other end.
    if !draft.is_file() || (locked.exists() && !locked.is_file()) {
        log::warn!("{}: is no draft, or its lock is no file", draft.display());
        return None;
    }
    let lock = OpenOptions::new().create(true).truncate(false).write(true).open(locked);
    let lock = lock.inspect_err(|error| log::warn!("{}: cannot be claimed: {error}", draft.display())).ok()?;
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return None,
        Err(TryLockError::Error(error)) => {
            log::warn!("{}: cannot be claimed: {error}", draft.display());
            return None;
        }
    }
    match read(&draft) {
        Ok((Header { title, file, on_disk, unix_secs }, scene)) => {
            Some(Found { scene, title, file, on_disk, unix_secs, draft, _lock: lock })
        }
        Err(error) => {
            log::warn!("{}: is no draft: {}", draft.display(), sentence(&*error));
            None
        }
    }
}

fn read(draft: &Path) -> Result<(Header, Scene), Box<dyn std::error::Error>> {
    let text = String::from_utf8(disk::read(draft, MAX_BYTES)?)?;
    let line = text.lines().next().and_then(|line| line.strip_prefix(MARK)).ok_or("its first line is missing")?;
    let header = serde_json::from_str(line)?;
    Ok((header, Scene::from_ron(&text, DRAFT)?))
}

/// Finds a name under which no living or dead program has left a draft, and takes its lock.
fn own_name(folder: &Path) -> io::Result<(File, PathBuf)> {
    let pid = std::process::id();
    for attempt in 0..MAX_NAME_ATTEMPTS {
        let name = if attempt == 0 { format!("{pid}.ron") } else { format!("{pid}-{attempt}.ron") };
        let draft = folder.join(name);
        let path = draft.with_extension("lock");
        let lock = OpenOptions::new().create(true).truncate(false).write(true).open(path)?;
        match lock.try_lock() {
            Ok(()) if !draft.exists() => return Ok((lock, draft)),
            Ok(()) | Err(TryLockError::WouldBlock) => {}
            Err(TryLockError::Error(error)) => return Err(error),
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, "every name for a draft is taken"))
}

fn remove(path: &Path) {
    if let Err(error) = fs::remove_file(path)
        && error.kind() != io::ErrorKind::NotFound
    {
        log::warn!("{}: cannot be removed: {error}", path.display());
    }
}

fn when(unix_secs: i64, now: &Zoned) -> String {
    let zone: TimeZone = now.time_zone().clone();
    let Ok(then) = Timestamp::from_second(unix_secs) else { return "an unknown time".to_owned() };
    let then = then.to_zoned(zone);
    let format = if then.date() == now.date() { "%H:%M" } else { "%H:%M on %-d %B" };
    then.strftime(format).to_string()
}

#[cfg(test)]
#[path = "recovery_tests.rs"]
mod tests;
