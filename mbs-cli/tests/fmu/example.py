from fmpy import simulate_fmu

result = simulate_fmu("cart_pole.fmu", fmi_type="CoSimulation", stop_time=2, output_interval=0.5,
                      start_values={"m_bob": 0.2}, output=["x", "theta", "energy"])
for row in result:
    print("%.9f %.9f %.9f %.9f" % tuple(row))
