package r1_ajpf;

import ail.syntax.Message;
import ail.syntax.Predicate;
import gwendolen.mas.VerificationofAutonomousSystemsEnvironment;
import java.util.HashSet;
import java.util.Set;

/** Shows each trigger freely, anew at the start, at every action and whenever the agent is idle. */
public class Env extends VerificationofAutonomousSystemsEnvironment {

    private static final String[] TRIGGERS = {
        "too_close",
    };

    @Override
    public Set<Predicate> generate_percepts() {
        Set<Predicate> percepts = new HashSet<Predicate>();
        for (String trigger : TRIGGERS) {
            if (random_bool_generator.nextBoolean()) {
                percepts.add(new Predicate(trigger));
            }
        }
        return percepts;
    }

    @Override
    public Set<Message> generate_messages() {
        return new HashSet<Message>();
    }

    /** Runs never end: where the agent has nothing to do, the triggers are drawn again. */
    @Override
    public boolean done() {
        if (mas != null && getScheduler() != null && getScheduler().getActiveJobbers().isEmpty()) {
            Set<Predicate> percepts = generate_percepts();
            clearPercepts();
            for (Predicate percept : percepts) {
                addPercept(percept);
            }
        }
        return false;
    }
}
