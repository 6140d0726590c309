// Shortest runs to each verdict, from the definition of the language and not from the monitor's formulas.
#![allow(non_snake_case)]

use r1_monitor::{Inputs, Monitor, Verdict};

#[test]
fn r1_soonest_pending() {
    let mut monitor = Monitor::new();
    for _ in 0..1 {
        let inputs = Inputs {
            too_close: Some(true),
            stopped: Some(true),
        };
        let outcome = monitor.step(&inputs).r1;
        assert_eq!(outcome.verdict, Verdict::Pending);
        assert_eq!(outcome.finite, Some(true));
    }
}

#[test]
fn r1_soonest_pending_unmet() {
    let mut monitor = Monitor::new();
    for _ in 0..1 {
        let inputs = Inputs {
            too_close: Some(true),
            stopped: Some(false),
        };
        let outcome = monitor.step(&inputs).r1;
        assert_eq!(outcome.verdict, Verdict::Pending);
        assert_eq!(outcome.finite, Some(false));
    }
}
