(** * The exact expression of omega_d' by yaw, pitch and roll

    docs/sharp-bound.md, steps 2 and 3; controller-core/src/attitude_reference.rs
    and the header of controller-core/src/certificate/sharp.rs. The frame and
    its rates are those of [DesiredFrame], for a heading by its angle psi. *)

From Coq Require Import Reals Lra Nsatz.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Direction DesiredFrame.
Open Scope R_scope.

Section Angles.

(** u, m/s^2, with u' and u''; psi, rad, with psi' and psi''. *)
Variables (u u_1 : R -> space) (psi psi_1 : R -> R) (t : R) (u_2 : space) (psi_2 : R).

Definition nu (s : R) : space := {| x := cos (psi s); y := sin (psi s); z := 0 |}.
Definition nu_1 (s : R) : space := {| x := - (psi_1 s * sin (psi s)); y := psi_1 s * cos (psi s); z := 0 |}.
Definition nu_2 : space :=
  {| x := - (psi_2 * sin (psi t)) - psi_1 t * psi_1 t * cos (psi t);
     y := psi_2 * cos (psi t) - psi_1 t * psi_1 t * sin (psi t); z := 0 |}.

Let rho := rho u.
Let rho_1 := rho_1 u u_1.
Let upsilon := upsilon u nu.
Let varpi := varpi u nu.
Let varpi_1 := varpi_1 u u_1 nu nu_1.
Let omega := omega u u_1 nu nu_1.
Let side (s : R) : space := cross (rho s) (upsilon s).

(** Pitch theta and roll phi by their cosines and sines. *)
Definition cos_roll (s : R) : R := length (varpi s).
Definition sin_roll (s : R) : R := - dot (sideways (nu s)) (rho s).
Definition cos_pitch (s : R) : R := z (rho s) / cos_roll s.
Definition sin_pitch (s : R) : R := dot (rho s) (nu s) / cos_roll s.

Lemma circle : forall a, cos a * cos a + sin a * sin a = 1.
Proof. intros a. pose proof (sin2_cos2 a) as H. unfold Rsqr in H. lra. Qed.

Lemma nu_unit : forall s, x (nu s) * x (nu s) + y (nu s) * y (nu s) = 1.
Proof. intros s. apply circle. Qed.

Lemma cos_roll_positive : forall s, 0 < z (u s) -> 0 < cos_roll s.
Proof. intros s Hs. apply varpi_positive; [exact Hs | apply nu_unit]. Qed.

Lemma roll_on_circle : forall s, 0 < z (u s) -> cos_roll s * cos_roll s + sin_roll s * sin_roll s = 1.
Proof.
  intros s Hs. unfold cos_roll, sin_roll. rewrite length_squared. unfold varpi.
  rewrite varpi_is_a_product. fold rho.
  assert (Hr : square (rho s) = 1) by (apply direction_unit, u_length; exact Hs).
  assert (Hn : square (sideways (nu s)) = 1) by (rewrite <- (nu_unit s); unfold sideways; components; ring).
  replace (square (cross (sideways (nu s)) (rho s)))
    with (square (sideways (nu s)) * square (rho s) - dot (sideways (nu s)) (rho s) * dot (sideways (nu s)) (rho s))
    by (generalize (sideways (nu s)) (rho s); intros a b; components; ring).
  rewrite Hr, Hn. ring.
Qed.

(** R_d = R_z(psi) R_y(theta) R_x(phi), column by column. *)
Theorem three_turns : forall s, 0 < z (u s) ->
  upsilon s = {| x := cos (psi s) * cos_pitch s; y := sin (psi s) * cos_pitch s; z := - sin_pitch s |} /\
  side s = {| x := cos (psi s) * sin_pitch s * sin_roll s - sin (psi s) * cos_roll s;
              y := sin (psi s) * sin_pitch s * sin_roll s + cos (psi s) * cos_roll s;
              z := cos_pitch s * sin_roll s |} /\
  rho s = {| x := cos (psi s) * sin_pitch s * cos_roll s + sin (psi s) * sin_roll s;
             y := sin (psi s) * sin_pitch s * cos_roll s - cos (psi s) * sin_roll s;
             z := cos_pitch s * cos_roll s |}.
Proof.
  intros s Hs. pose proof (cos_roll_positive s Hs) as Hc. pose proof (circle (psi s)) as Hcircle.
  assert (Hu : upsilon s = {| x := cos (psi s) * cos_pitch s; y := sin (psi s) * cos_pitch s; z := - sin_pitch s |}).
  { unfold upsilon, DesiredFrame.upsilon, direction. fold varpi. fold (cos_roll s). unfold cos_pitch, sin_pitch.
    apply same; unfold varpi, DesiredFrame.varpi; fold rho; unfold nu; components; field; lra. }
  assert (Hr : rho s = {| x := cos (psi s) * sin_pitch s * cos_roll s + sin (psi s) * sin_roll s;
                          y := sin (psi s) * sin_pitch s * cos_roll s - cos (psi s) * sin_roll s;
                          z := cos_pitch s * cos_roll s |}).
  { unfold sin_pitch, cos_pitch, sin_roll, sideways, nu. apply same; components.
    - transitivity (x (rho s) * (cos (psi s) * cos (psi s) + sin (psi s) * sin (psi s))); [rewrite Hcircle; ring|].
      field. lra.
    - transitivity (y (rho s) * (cos (psi s) * cos (psi s) + sin (psi s) * sin (psi s))); [rewrite Hcircle; ring|].
      field. lra.
    - field. lra. }
  assert (Hpitch : cos_pitch s * cos_pitch s + sin_pitch s * sin_pitch s = 1).
  { assert (Hunit : square (upsilon s) = 1) by (apply direction_unit; exact Hc).
    rewrite Hu in Hunit. components. rewrite <- Hunit, <- (Rmult_1_l (cos_pitch s * cos_pitch s)), <- Hcircle. ring. }
  split; [exact Hu | split; [|exact Hr]].
  unfold side. rewrite Hr, Hu. components.
  clear Hu Hr Hc. revert Hcircle Hpitch.
  generalize (cos_pitch s) (sin_pitch s) (cos_roll s) (sin_roll s) (cos (psi s)) (sin (psi s)).
  intros c d f e a b Hab Hcd.
  apply same; cbn [x y z].
  - transitivity (a * d * e - b * f * (c * c + d * d)); [ring | rewrite Hcd; ring].
  - transitivity (b * d * e + a * f * (c * c + d * d)); [ring | rewrite Hcd; ring].
  - transitivity (c * e * (a * a + b * b)); [ring | rewrite Hab; ring].
Qed.

Lemma pitch_on_circle : forall s, 0 < z (u s) -> cos_pitch s * cos_pitch s + sin_pitch s * sin_pitch s = 1.
Proof.
  intros s Hs. destruct (three_turns s Hs) as (Hu & _ & _).
  assert (Hunit : square (upsilon s) = 1) by (apply direction_unit, cos_roll_positive, Hs).
  rewrite Hu in Hunit. pose proof (circle (psi s)) as Hcircle. components.
  rewrite <- Hunit, <- (Rmult_1_l (cos_pitch s * cos_pitch s)), <- Hcircle. ring.
Qed.

(** ** omega_d3 = (psi' cos theta - omega_d2 sin phi) / cos phi *)

Definition yaw_rate (s : R) : R := (psi_1 s * cos_pitch s - sin_roll s * y (omega s)) / cos_roll s.

Lemma lagrange : forall a b c d, dot (cross a b) (cross c d) = dot a c * dot b d - dot a d * dot b c.
Proof. intros. components. ring. Qed.

Theorem yaw_rate_exact : forall s, 0 < z (u s) -> z (omega s) = yaw_rate s.
Proof.
  intros s Hs. pose proof (cos_roll_positive s Hs) as Hc.
  destruct (frame_at_t u u_1 nu nu_1 s Hs (nu_unit s)) as (F1 & F2 & F3 & F4 & F5 & F6).
  fold rho in F1, F3, F4. fold rho_1 in F4. fold upsilon in F2, F3.
  assert (Hz : z (omega s) = dot (side s) (varpi_1 s) / cos_roll s).
  { unfold omega, DesiredFrame.omega, turning. cbn [z]. fold rho upsilon.
    replace (- dot (upsilon s) (cross (rho s) (upsilon_1 u u_1 nu nu_1 s)))
      with (dot (side s) (upsilon_1 u u_1 nu nu_1 s))
      by (unfold side; generalize (upsilon s) (rho s) (upsilon_1 u u_1 nu nu_1 s); intros a b c; components; ring).
    unfold upsilon_1, direction_rate, across. fold varpi varpi_1. fold (upsilon s). fold (cos_roll s).
    transitivity ((dot (side s) (varpi_1 s) - dot (direction (varpi s)) (varpi_1 s) * dot (side s) (upsilon s)) /
      cos_roll s).
    - change (direction (varpi s)) with (upsilon s).
      generalize (dot (upsilon s) (varpi_1 s)). intros m.
      generalize (side s) (upsilon s) (varpi_1 s). intros a b c. components. field. lra.
    - assert (E : dot (side s) (upsilon s) = 0).
      { unfold side. generalize (rho s) (upsilon s). intros a b. components. ring. }
      rewrite E. f_equal. ring. }
  rewrite Hz. unfold yaw_rate. f_equal.
  unfold varpi_1, DesiredFrame.varpi_1. fold rho rho_1.
  assert (Hn : sideways (nu_1 s) = scaled (- psi_1 s) (nu s)).
  { unfold sideways, nu_1, nu. apply same; components; ring. }
  rewrite Hn.
  transitivity (- psi_1 s * dot (side s) (cross (nu s) (rho s)) + dot (side s) (cross (sideways (nu s)) (rho_1 s))).
  { generalize (side s) (nu s) (rho s) (cross (sideways (nu s)) (rho_1 s)). intros a b c d. components. ring. }
  unfold side. rewrite !lagrange. fold (square (rho s)).
  rewrite F1, F4, (dot_symmetric (upsilon s) (rho s)), F3.
  destruct (three_turns s Hs) as (Hu & _ & _).
  assert (E1 : dot (upsilon s) (nu s) = cos_pitch s).
  { rewrite Hu. pose proof (circle (psi s)) as Hcircle. unfold nu. components.
    transitivity (cos_pitch s * (cos (psi s) * cos (psi s) + sin (psi s) * sin (psi s))); [ring | rewrite Hcircle;
      ring]. }
  assert (E2 : dot (upsilon s) (rho_1 s) = y (omega s)) by reflexivity.
  rewrite E1, E2. unfold sin_roll. rewrite (dot_symmetric (rho s) (sideways (nu s))). ring.
Qed.

(** ** Their derivatives at t *)

Hypothesis u_moves : moves u t (u_1 t).
Hypothesis u_1_moves : moves u_1 t u_2.
Hypothesis psi_moves : is_derive psi t (psi_1 t).
Hypothesis psi_1_moves : is_derive psi_1 t psi_2.
Hypothesis upwards : 0 < z (u t).

Let omega_1 := omega_1 u u_1 nu nu_1 t u_2 nu_2.

Lemma nu_moves : moves nu t (nu_1 t).
Proof.
  assert (Hc : is_derive (fun s => cos (psi s)) t (- (psi_1 t * sin (psi t)))).
  { eapply derive_as; [exact (is_derive_comp cos psi t _ _ (is_derive_cos (psi t)) psi_moves)|].
    unfold scal. cbn. unfold mult. cbn. ring. }
  assert (Hs : is_derive (fun s => sin (psi s)) t (psi_1 t * cos (psi t))).
  { eapply derive_as; [exact (is_derive_comp sin psi t _ _ (is_derive_sin (psi t)) psi_moves)|].
    unfold scal. cbn. unfold mult. cbn. ring. }
  exact (conj Hc (conj Hs (derive_constant 0 t))).
Qed.

Lemma nu_1_moves : moves nu_1 t nu_2.
Proof.
  destruct nu_moves as (Hc & Hs & _). cbn in Hc, Hs.
  assert (H1 : is_derive (fun s => - (psi_1 s * sin (psi s))) t
    (- (psi_2 * sin (psi t)) - psi_1 t * psi_1 t * cos (psi t))).
  { eapply derive_as; [exact (derive_opposite _ _ _ (derive_product _ _ _ _ _ psi_1_moves Hs))|]. cbn. ring. }
  assert (H2 : is_derive (fun s => psi_1 s * cos (psi s)) t
    (psi_2 * cos (psi t) - psi_1 t * psi_1 t * sin (psi t))).
  { eapply derive_as; [exact (derive_product _ _ _ _ _ psi_1_moves Hc)|]. cbn. ring. }
  exact (conj H1 (conj H2 (derive_constant 0 t))).
Qed.

Lemma rho_1_in_frame : rho_1 t = sub (scaled (y (omega t)) (upsilon t)) (scaled (x (omega t)) (side t)).
Proof.
  destruct (frame_at_t u u_1 nu nu_1 t upwards (nu_unit t)) as (F1 & F2 & F3 & F4 & F5 & F6).
  exact (proj1 (frame_turns _ _ _ _ F1 F2 F3 F4 F5 F6)).
Qed.

Lemma sideways_nu_1 : sideways (nu_1 t) = scaled (- psi_1 t) (nu t).
Proof. unfold sideways, nu_1, nu. apply same; components; ring. Qed.

Ltac in_angles := destruct (three_turns t upwards) as (Hu & Hside & Hrho);
  pose proof (circle (psi t)) as Hcircle; pose proof (pitch_on_circle t upwards) as Hpitch;
  pose proof (roll_on_circle t upwards) as Hroll.

(** phi' = omega_d1 + psi' sin theta. *)
Lemma sin_roll_moves : is_derive sin_roll t (cos_roll t * (x (omega t) + psi_1 t * sin_pitch t)).
Proof.
  eapply derive_as.
  - exact (derive_opposite _ _ _ (moves_dot _ _ _ _ _ (moves_sideways t _ _ nu_moves) (rho_moves u u_1 t u_moves
    upwards))).
  - cbv beta. fold rho_1 rho. rewrite sideways_nu_1, rho_1_in_frame. in_angles. rewrite Hu, Hside, Hrho.
    unfold sideways, nu. components. revert Hcircle Hpitch Hroll.
    generalize (cos_pitch t) (sin_pitch t) (cos_roll t) (sin_roll t) (cos (psi t)) (sin (psi t))
      (x (omega t)) (y (omega t)) (psi_1 t).
    intros c d f e a b p q r Hab Hcd Hef. nsatz.
Qed.

Lemma cos_roll_moves : is_derive cos_roll t (- sin_roll t * (x (omega t) + psi_1 t * sin_pitch t)).
Proof.
  eapply derive_as.
  - apply (length_moves varpi t (varpi_1 t)).
    + now apply cos_roll_positive.
    + exact (varpi_moves u u_1 nu nu_1 t u_moves nu_moves upwards).
  - change (direction (varpi t)) with (upsilon t). unfold varpi_1, DesiredFrame.varpi_1. fold rho rho_1.
    rewrite sideways_nu_1, rho_1_in_frame. in_angles. rewrite Hu, Hside, Hrho.
    unfold sideways, nu. components. revert Hcircle Hpitch Hroll.
    generalize (cos_pitch t) (sin_pitch t) (cos_roll t) (sin_roll t) (cos (psi t)) (sin (psi t))
      (x (omega t)) (y (omega t)) (psi_1 t).
    intros c d f e a b p q r Hab Hcd Hef. nsatz.
Qed.

(** theta' = (omega_d2 - psi' cos theta sin phi) / cos phi. *)
Lemma cos_pitch_moves : is_derive cos_pitch t
  (- sin_pitch t * ((y (omega t) - psi_1 t * cos_pitch t * sin_roll t) / cos_roll t)).
Proof.
  pose proof (cos_roll_positive t upwards) as Hc.
  pose proof (rho_moves u u_1 t u_moves upwards) as (_ & _ & Hz). fold rho rho_1 in Hz.
  eapply derive_as.
  - apply (derive_quotient (fun s => z (rho s)) cos_roll t); [exact Hz | exact cos_roll_moves | lra].
  - cbv beta. rewrite rho_1_in_frame. in_angles. rewrite Hu, Hside, Hrho. components.
    revert Hpitch Hroll Hc.
    generalize (cos_pitch t) (sin_pitch t) (cos_roll t) (sin_roll t) (x (omega t)) (y (omega t)) (psi_1 t).
    intros c d f e p q r Hcd Hef Hf. field. lra.
Qed.

(** The part of w orthogonal to rho, by its components along body x and y. *)
Definition along_x (w : space) : R := dot (upsilon t) w.
Definition along_y (w : space) : R := dot (side t) w.

(** omega_d' about the first two axes: n = |u|, r = rho . u'. *)
Theorem tilting_exact :
  let n := length (u t) in let r := dot (rho t) (u_1 t) in
  y (omega t) = along_x (u_1 t) / n /\ x (omega t) = - along_y (u_1 t) / n /\
  x omega_1 = - along_y u_2 / n - 2 * r / n * x (omega t) + z (omega t) * y (omega t) /\
  y omega_1 = along_x u_2 / n - 2 * r / n * y (omega t) - z (omega t) * x (omega t).
Proof.
  intros n r. assert (Hn : 0 < n) by (apply u_length; exact upwards).
  destruct (frame_at_t u u_1 nu nu_1 t upwards (nu_unit t)) as (F1 & F2 & F3 & F4 & F5 & F6).
  fold rho upsilon in F3.
  assert (Hside : dot (side t) (rho t) = 0).
  { unfold side. generalize (rho t) (upsilon t). intros a b. components. ring. }
  assert (Hrate : forall e, dot e (rho t) = 0 -> dot e (rho_1 t) = dot e (u_1 t) / n).
  { intros e He. unfold rho_1, DesiredFrame.rho_1, direction_rate, across.
    change (direction (u t)) with (rho t). fold r. fold n.
    transitivity ((dot e (u_1 t) - r * dot e (rho t)) / n).
    - generalize (rho t). intros c. components. field. lra.
    - rewrite He. field. lra. }
  assert (Hsecond : forall e, dot e (rho t) = 0 ->
    dot e (rho_2 u u_1 t u_2) = dot e u_2 / n - 2 * r / n * dot e (rho_1 t)).
  { intros e He. unfold rho_2, direction_second, across.
    change (direction (u t)) with (rho t). change (direction_rate (u t) (u_1 t)) with (rho_1 t). fold r. fold n.
    generalize (square (rho_1 t)) (dot (rho t) u_2). intros k m.
    transitivity ((dot e u_2 - m * dot e (rho t)) / n - 2 * r / n * dot e (rho_1 t) - k * dot e (rho t)).
    - generalize (rho t) (rho_1 t). intros c d. components. field. lra.
    - rewrite He. field. lra. }
  assert (Hx : y (omega t) = dot (upsilon t) (rho_1 t)) by reflexivity.
  assert (Hy : x (omega t) = - dot (side t) (rho_1 t)).
  { unfold omega, DesiredFrame.omega, turning, side. cbn [x]. fold rho rho_1 upsilon.
    generalize (rho t) (rho_1 t) (upsilon t). intros a b c. components. ring. }
  rewrite dot_symmetric in F3.
  unfold along_x, along_y. split; [|split; [|split]].
  - rewrite Hx. now apply Hrate.
  - rewrite Hy, (Hrate _ Hside). field. lra.
  - assert (E : x omega_1 = y (omega t) * z (omega t) + - dot (side t) (rho_2 u u_1 t u_2)).
    { unfold omega_1, DesiredFrame.omega_1, products, turning. cbn [x add]. fold omega rho upsilon. f_equal.
      unfold side. generalize (rho t) (upsilon t) (rho_2 u u_1 t u_2). intros a b c. components. ring. }
    rewrite E, (Hsecond _ Hside), Hy. field. lra.
  - assert (E : y omega_1 = - (x (omega t) * z (omega t)) + dot (upsilon t) (rho_2 u u_1 t u_2)) by reflexivity.
    rewrite E, (Hsecond _ F3), Hx. field. lra.
Qed.

(** And about the third. *)
Theorem yaw_acceleration_exact :
  let n := length (u t) in let r := dot (rho t) (u_1 t) in
  z omega_1 = psi_2 * cos_pitch t / cos_roll t
    - sin_roll t / cos_roll t * (along_x u_2 / n - 2 * r / n * y (omega t))
    + (2 * (psi_1 t * psi_1 t) * sin_pitch t * cos_pitch t * sin_roll t
       - 2 * psi_1 t * sin_pitch t * y (omega t) + 2 * psi_1 t * cos_pitch t * sin_roll t * x (omega t)
       - x (omega t) * y (omega t) * (1 + sin_roll t * sin_roll t)) / (cos_roll t * cos_roll t).
Proof.
  intros n r. pose proof (cos_roll_positive t upwards) as Hc.
  destruct tilting_exact as (_ & _ & _ & Hy1). fold n r in Hy1.
  destruct (omega_moves u u_1 nu nu_1 t u_2 nu_2 u_moves u_1_moves nu_moves nu_1_moves upwards (nu_unit t))
    as (_ & Hw2 & Hw3). fold omega in Hw2, Hw3. fold omega_1 in Hw2, Hw3.
  assert (Hnear : locally t (fun s => z (omega s) = yaw_rate s)).
  { assert (Hcont : continuous (fun s => z (u s)) t).
    { apply (ex_derive_continuous (fun s => z (u s))). exists (z (u_1 t)). apply u_moves. }
    apply (filter_imp (fun s => 0 < z (u s))); [intros s Hs; now apply yaw_rate_exact|].
    apply (Hcont (fun v => 0 < v)). apply open_gt. exact upwards. }
  pose proof (is_derive_ext_loc _ _ _ _ Hnear Hw3) as Hyaw.
  pose proof (derive_quotient _ _ _ _ _ (derive_difference _ _ _ _ _
    (derive_product _ _ _ _ _ psi_1_moves cos_pitch_moves) (derive_product _ _ _ _ _ sin_roll_moves Hw2))
    cos_roll_moves ltac:(lra)) as Hexact.
  assert (Hone : forall (g : R -> R) (l m : R), is_derive g t l -> is_derive g t m -> l = m).
  { intros g l m Hl Hm. apply is_derive_unique in Hl. apply is_derive_unique in Hm. congruence. }
  pose proof (Hone yaw_rate _ _ Hyaw Hexact) as Hsame. clear Hyaw Hexact Hnear Hw2 Hw3 Hone. rewrite Hsame.
  cbv beta. rewrite Hy1, (yaw_rate_exact t upwards). unfold yaw_rate.
  pose proof (roll_on_circle t upwards) as Hroll.
  revert Hroll Hc.
  generalize (cos_pitch t) (sin_pitch t) (cos_roll t) (sin_roll t) (x (omega t)) (y (omega t)) (psi_1 t)
    (along_x u_2 / n) (2 * r / n).
  intros c d f e p q k v m Hef Hf.
  assert (He : e * e = 1 - f * f) by lra.
  apply Rmult_eq_reg_r with (f * f); [|apply Rmult_integral_contrapositive; lra].
  field_simplify; [|lra|lra]. replace (e ^ 2) with (1 - f * f) by (rewrite <- He; ring). ring.
Qed.

End Angles.
