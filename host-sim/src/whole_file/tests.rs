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
    assert!(WholeFile::write(&directory.join("log.csv"), "text").is_err());
    assert_eq!(count(&directory), 1);
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
