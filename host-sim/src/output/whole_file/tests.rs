//! Files finished and not, and names that belong to something else.

use super::*;

fn directory(test: &str) -> PathBuf {
    let directory = std::env::temp_dir().join(format!("host-sim-{test}-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    directory
}

fn count(directory: &Path) -> usize {
    std::fs::read_dir(directory).unwrap().count()
}

#[test]
fn a_file_that_was_not_finished_leaves_nothing_behind() {
    let directory = directory("unfinished");
    let path = directory.join("log.csv");
    let mut file = WholeFile::create(&path).unwrap();
    file.write_all(b"half").unwrap();
    assert!(!path.exists());
    drop(file);
    assert_eq!(count(&directory), 0);
    WholeFile::write(&path, "whole").unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "whole");
    assert_eq!(count(&directory), 1);
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn a_name_that_is_taken_by_a_directory_leaves_nothing_behind() {
    let directory = directory("taken");
    std::fs::create_dir(directory.join("log.csv")).unwrap();
    // At once, not after hours of work.
    for refused in
        [WholeFile::create(&directory.join("log.csv")).map(drop), WholeFile::try_name(&directory.join("log.csv"))]
    {
        assert_eq!(refused.unwrap_err().kind(), io::ErrorKind::IsADirectory);
    }
    assert_eq!(count(&directory), 1);
    std::fs::remove_dir_all(&directory).unwrap();
}

#[cfg(unix)]
#[test]
fn a_private_file_is_its_owners_alone_and_a_file_that_is_replaced_keeps_its_mode() {
    use std::fs::{Permissions, set_permissions};
    use std::os::unix::fs::PermissionsExt;
    let directory = directory("mode");
    let (secret, log) = (directory.join("parameters.bin"), directory.join("log.csv"));
    let modes = || {
        let entries = std::fs::read_dir(&directory).unwrap().map(|entry| entry.unwrap().metadata().unwrap());
        entries.map(|found| found.permissions().mode() & 0o777).collect::<Vec<u32>>()
    };
    let write_secret = |expected: u32| {
        let mut file = WholeFile::private(&secret).unwrap();
        file.write_all(b"key").unwrap();
        // Also while it grows.
        assert!(modes().iter().all(|mode| *mode == expected), "{:?}", modes());
        file.finish().unwrap();
        assert_eq!(modes(), [expected]);
    };
    write_secret(0o600);
    write_secret(0o600);
    for mode in [0o400, 0o640] {
        set_permissions(&secret, Permissions::from_mode(mode)).unwrap();
        write_secret(mode);
    }
    std::fs::remove_file(&secret).unwrap();
    std::fs::write(&log, "by the system's own means").unwrap();
    let usual = modes();
    std::fs::remove_file(&log).unwrap();
    WholeFile::write(&log, "new").unwrap();
    assert_eq!(modes(), usual);
    for mode in [0o600, 0o444] {
        set_permissions(&log, Permissions::from_mode(mode)).unwrap();
        WholeFile::write(&log, "replaced").unwrap();
        assert_eq!(modes(), [mode]);
    }
    std::fs::remove_dir_all(&directory).unwrap();
}

#[cfg(unix)]
#[test]
fn a_link_that_lies_where_a_file_is_to_grow_is_not_written_through() {
    let directory = directory("laid");
    let (path, victim) = (directory.join("log.csv"), directory.join("victim"));
    std::fs::write(&victim, "untouched").unwrap();
    let grows = WholeFile::create(&path).unwrap().names.as_ref().unwrap().0.clone();
    let name = grows.file_name().unwrap().to_str().unwrap();
    let parts: Vec<&str> = name.split('.').collect();
    let number: u64 = parts[3].parse().unwrap();
    for next in number..number + 50 {
        let laid = name.replace(&format!(".{number}."), &format!(".{next}."));
        std::os::unix::fs::symlink(&victim, directory.join(laid)).unwrap();
    }
    WholeFile::write(&path, "whole").unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "whole");
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "untouched");
    std::fs::remove_dir_all(&directory).unwrap();
}

#[cfg(unix)]
#[test]
fn a_device_is_written_to_and_stays_a_device() {
    let directory = directory("device");
    let link = directory.join("sink");
    std::os::unix::fs::symlink("/dev/null", &link).unwrap();
    WholeFile::write(&link, "gone").unwrap();
    assert_eq!(std::fs::read_link(&link).unwrap(), Path::new("/dev/null"));
    std::fs::remove_dir_all(&directory).unwrap();
}

#[cfg(unix)]
#[test]
fn a_link_stays_one_and_what_it_stands_for_is_written_there_or_not() {
    let directory = directory("link");
    std::fs::create_dir(directory.join("elsewhere")).unwrap();
    let link = directory.join("link.toml");
    std::os::unix::fs::symlink("elsewhere/real.toml", &link).unwrap();
    for text in ["new", "old"] {
        WholeFile::write(&link, text).unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_to_string(directory.join("elsewhere/real.toml")).unwrap(), text);
    }
    let (one, other) = (directory.join("one"), directory.join("other"));
    std::os::unix::fs::symlink(&one, &other).unwrap();
    std::os::unix::fs::symlink(&other, &one).unwrap();
    assert!(WholeFile::write(&one, "text").is_err());
    assert_eq!((count(&directory), count(&directory.join("elsewhere"))), (4, 1));
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn a_name_may_be_as_long_as_names_can_be_and_two_files_grow_side_by_side() {
    let directory = directory("long");
    let path = directory.join("n".repeat(255));
    let (mut one, mut other) = (WholeFile::create(&path).unwrap(), WholeFile::create(&path).unwrap());
    one.write_all(b"one").unwrap();
    other.write_all(b"other").unwrap();
    one.finish().unwrap();
    other.finish().unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "other");
    assert_eq!(count(&directory), 1);
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn what_a_killed_program_left_of_a_file_is_known_by_the_name_it_was_to_get() {
    let directory = directory("killed");
    let path = directory.join("000001.arrow");
    // As a kill does: nothing is dropped.
    std::mem::forget(WholeFile::create(&path).unwrap());
    let left = std::fs::read_dir(&directory).unwrap().next().unwrap().unwrap().path();
    assert!(is_unfinished(&left, &path), "{}", left.display());
    for other in ["000002.arrow", "000001.arrow.part"] {
        assert!(
            !is_unfinished(&left, &directory.join(other)) && !is_unfinished(&directory.join(other), &path),
            "{other}"
        );
    }
    std::fs::remove_dir_all(&directory).unwrap();
}
