//! When tracing stops.

use super::*;
use crate::viewer::document::goal::{Goal, Stop};

fn is_done(app: &App) -> bool {
    app.render.as_ref().unwrap().is_done()
}

#[test]
fn each_goal_has_its_field() {
    let mut desk = Desk::new();
    desk.document(|d| d.set_limit(1 << 32));
    for (name, field, others) in [
        ("Error", "Error limit", ["Pass limit", "Time limit"]),
        ("Time", "Time limit", ["Pass limit", "Error limit"]),
        ("Passes", "Pass limit", ["Error limit", "Time limit"]),
    ] {
        desk.click(name);
        desk.harness.run_steps(2);
        desk.harness.get_by_role_and_label(Role::SpinButton, field);
        for other in others {
            let other = desk.harness.query_by_role_and_label(Role::SpinButton, other);
            assert!(other.is_none(), "{name}");
        }
        assert_eq!(desk.harness.unnamed_widgets(), Vec::<String>::new());
    }
}

#[test]
fn an_error_ends_where_a_file_of_that_error_ends() {
    let mut desk = Desk::done(1);
    let epoch = desk.newest().epoch;
    desk.click("Error");
    desk.type_into("Error limit", "5");
    assert_eq!(desk.doc().goal, Goal { stop: Stop::Error, passes: 1, error: 0.05, seconds: 60.0 });
    desk.until("the error", is_done);
    let newest = desk.newest();
    assert_eq!(newest.epoch, epoch, "nothing was thrown away");
    let rule = burnish::progressive::StopRule { wanted: 0.05 };
    assert_eq!(rule.next(newest.passes, newest.error.as_ref()), None);
    assert!(newest.error.unwrap().relative.interval.high <= 0.05);
    // The same looks as without a window.
    let (params, passes) = (desk.doc().params.clone(), newest.passes);
    let mut limit = burnish::progressive::StopRule::FIRST;
    loop {
        let picture = burnish::progressive::render(params.clone(), limit, 1).unwrap();
        match rule.next(picture.passes, picture.error.as_ref()) {
            Some(next) => limit = next,
            None => break,
        }
    }
    assert_eq!(passes, limit);
    desk.until_at_rest();
    assert!(desk.harness.query_by_label("done").is_some());
}

#[test]
fn a_time_ends_and_a_change_and_a_longer_time_go_on() {
    let mut desk = Desk::new();
    desk.document(|d| d.set_limit(1 << 32));
    desk.click("Time");
    desk.type_into("Time limit", "0.2");
    assert_eq!((desk.doc().goal.stop, desk.doc().goal.seconds), (Stop::Time, 0.2));
    let stopped = |app: &App| {
        is_done(app) && app.render.as_ref().unwrap().newest.as_ref().unwrap().state == State::Paused
    };
    desk.until("the end", stopped);
    assert!(!desk.doc().paused && desk.newest().seconds >= 0.2);
    assert!(desk.harness.query_by_label("done").is_some());
    let (epoch, passes) = (desk.newest().epoch, desk.newest().passes);
    // A machine with much else to do may be past that already.
    let longer = desk.newest().seconds + 0.3;
    desk.type_into("Time limit", &format!("{longer:.2}"));
    desk.until("the end", stopped);
    assert!(desk.newest().passes > passes && desk.newest().epoch == epoch);
    desk.key(Key::Num1);
    desk.until_applied(epoch);
    desk.until("the end", stopped);
    assert!(desk.newest().seconds >= longer - 0.01);
}

#[test]
fn the_goal_is_told_while_it_is_ahead() {
    let mut desk = Desk::new();
    desk.document(|d| d.goal = Goal { stop: Stop::Time, seconds: 1e6, ..Goal::default() });
    desk.key(Key::Space);
    desk.until("pause", |app| {
        app.render.as_ref().unwrap().newest.as_ref().unwrap().state == State::Paused
    });
    desk.harness.get_by_label_contains("done in 12 d");
    desk.harness.get_by_label("paused");
}
