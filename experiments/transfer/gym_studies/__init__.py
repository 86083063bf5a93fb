"""Half cheetah and inverted pendulum: the Gymnasium studies of the SGAT paper."""
